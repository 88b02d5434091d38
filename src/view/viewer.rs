//! The whole of section 5.4.2 of the course notes in one call: what a program that draws for a
//! headset does with each quaternion off the line.

use super::ViewError;
use super::eyes::{Eye, InterpupillaryDistance, finite};
use super::head_neck::HeadNeck;
use super::mounting::Mounting;
use nalgebra::{Isometry3, Point3, RealField, Translation3, UnitQuaternion};

/// Who is looking, and from where.
///
/// ```
/// use vrduino::view::{self, eyes::{Eye, InterpupillaryDistance}, head_neck::HeadNeck};
/// use vrduino::view::{mounting::Mounting, viewer::Viewer};
/// use vrduino::units::Millimetres;
///
/// let viewer = Viewer {
///     mounting: Mounting::TurnedAround,
///     eyes: InterpupillaryDistance::of_the_notes(),
///     neck: HeadNeck::new(Millimetres(150.0), Millimetres(100.0))?,
///     position: [0.0, 1700.0, 0.0].into(),
/// };
/// // “QC 0.707 0.000 0.707 0.000”: the head has turned 90° to the left.
/// let q = view::from_stream([0.707, 0.0, 0.707, 0.0])?;
/// let right = viewer.view(q, Eye::Right)?.to_homogeneous();
/// # assert!((right[(0, 2)] + 1.0_f64).abs() < 1e-9);
/// # Ok::<(), view::ViewError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewer<T: RealField> {
    /// How the board sits on the headset.
    pub mounting: Mounting,
    /// How far apart the eyes are.
    pub eyes: InterpupillaryDistance<T>,
    /// What the head turns about.
    pub neck: HeadNeck<T>,
    /// Where the middle between the eyes is while the head is at rest, in millimetres in the
    /// world: the `eye` of the lectures' T(−eye).
    pub position: Point3<T>,
}

impl<T: RealField + Copy> Viewer<T> {
    /// The view of one eye, world to camera, for the board's orientation, body to world:
    ///
    /// T(∓ipd/2, 0, 0) · T(0, −l_n, l_h) · R⁻¹ · T(0, l_n, −l_h) · T(−position)
    ///
    /// # Errors
    ///
    /// [`ViewError::NotARotation`] if the quaternion is zero or not finite, [`ViewError::Position`]
    /// if the position is not finite or too far away.
    pub fn view(&self, board: UnitQuaternion<T>, eye: Eye) -> Result<Isometry3<T>, ViewError> {
        let to_head = self.neck.to_head(self.mounting.head(board))?;
        let to_rest = Translation3::from(-self.position.coords);
        finite(self.eyes.from_head(eye) * to_head * to_rest)
    }
}
