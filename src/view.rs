//! From the orientation to a picture (course notes, section 5.4; lectures “Head and Neck Model”):
//! where the head is turned, there the virtual camera looks.
//!
//! ```text
//! line ──► unit ──► mounting ──► inverse ──► head and neck ──► eye ──► projection
//! w x y z  again    of the board  R⁻¹         about the pivot    ±ipd/2   clip space
//! ```
//!
//! | file | notes |
//! |---|---|
//! | `gl_rotate` | algorithm 1: `glRotatef` |
//! | `inverse` | section 5.4.2: three ways to R⁻¹ |
//! | `mounting` | section 5.4.2: the board turned round on the headset |
//! | `eyes` | algorithm 2: the look-at of each eye |
//! | `head_neck` | algorithm 3: turning about the neck |
//! | `viewer` | all of it in one call |
//! | `projection` | lecture 2 recap: v_clip = M_proj M_view M_model v |
//!
//! **Frames.** The *camera* is OpenGL's: x to the right, y up, looking along −z. The *world* is the
//! camera's frame with the head at rest and facing its starting heading. A *view* takes points
//! from world to camera; its lengths are millimetres. A view is rigid, and has a type that can be
//! nothing else: `Isometry3`, whose `to_homogeneous` is the 4×4 matrix, and the storage of that,
//! column after column, is the order OpenGL takes it in.
//!
//! **Differences from the page.** Printed, algorithm 2 leaves the eyes standing in the world while
//! the head turns between them, and algorithm 3 puts the pivot in front of the face: see [`eyes`](crate::view::eyes)
//! and [`head_neck`](crate::view::head_neck). The printed forms are run in `tests/view.rs`.

use crate::orientation::quaternion;
use core::fmt;
use nalgebra::{Quaternion, RealField, UnitQuaternion, Vector3};

pub mod gl_rotate;

pub mod inverse;

pub mod mounting;

pub mod eyes;

pub mod head_neck;

pub mod viewer;

pub mod projection;

/// Why there is no view, or no projection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewError {
    /// The quaternion is zero or not finite.
    NotARotation,
    /// The axis of a rotation is zero or not finite.
    NoAxis,
    /// The angle is not finite.
    NoAngle,
    /// A measure of the wearer is negative, over a metre, or not finite.
    Measure,
    /// A position is not finite, or so far off that the view would not be.
    Position,
    /// The eye is at the point it looks at, or looks along its own up.
    NoDirection,
    /// The planes of a projection do not enclose a volume: near > 0 and far > near; right > left
    /// and top > bottom, or 0° < field of view < 180° and aspect > 0.
    NoVolume,
}

impl fmt::Display for ViewError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotARotation => "the quaternion is zero or not finite: drop the line it came in",
            Self::NoAxis => "the axis is zero or not finite: give it a direction",
            Self::NoAngle => "the angle is not finite",
            Self::Measure => "give the measure in millimetres, from 0 to 1000",
            Self::Position => "the position is not finite, or too far away: give it in millimetres",
            Self::NoDirection => "look at a point away from the eye, and not along up",
            Self::NoVolume => {
                "give 0 < near < far, left < right, bottom < top, 0 < field of view < 180°, aspect > 0"
            }
        })
    }
}

impl core::error::Error for ViewError {}

/// A quaternion w, x, y, z as it comes off the line (algorithm 1, line 2), of unit length again:
/// three decimals leave it up to 0.001 short or long (section 5.4).
///
/// # Errors
///
/// [`ViewError::NotARotation`] if it is zero or not finite.
pub fn from_stream<T: RealField + Copy>(
    [w, x, y, z]: [T; 4],
) -> Result<UnitQuaternion<T>, ViewError> {
    quaternion::unit(Quaternion::new(w, x, y, z)).ok_or(ViewError::NotARotation)
}

/// The same for one that claims to be of unit length already, which `new_unchecked` lets anyone.
fn unit<T: RealField + Copy>(q: UnitQuaternion<T>) -> Result<UnitQuaternion<T>, ViewError> {
    from_stream([q.w, q.i, q.j, q.k])
}

/// The direction of a vector of any finite length but zero.
fn direction<T: RealField + Copy>(v: Vector3<T>) -> Option<Vector3<T>> {
    quaternion::unit(Quaternion::from_imag(v)).map(|unit| unit.imag())
}
