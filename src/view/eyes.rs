//! Two eyes (course notes, algorithm 2): each half the inter-pupillary distance from the middle of
//! the head, along the **camera's** x.
//!
//! As printed, `glRotatef` comes before `setLookAtMatrix`, which makes R⁻¹ T(∓ipd/2, 0, 0): the eyes
//! stand still in the world and each turns on its own spot. At a yaw of 90° one eye is behind the
//! other, at 180° they have changed places. The other order, T(∓ipd/2, 0, 0) R⁻¹, is that of a head.
//! The lectures' R T(−eye) is the printed order too: right for a position of the *head*, wrong for
//! that of an eye.

use super::{ViewError, direction};
use crate::units::Millimetres;
use nalgebra::{Isometry3, Point3, RealField, Translation3, Vector3, convert};

/// Whose view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Eye {
    /// At −ipd/2.
    Left,
    /// At +ipd/2.
    Right,
}

/// The distance between the centres of the pupils, `ipd` of algorithm 2, in millimetres.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct InterpupillaryDistance<T>(Millimetres<T>);

impl<T: RealField + Copy> InterpupillaryDistance<T> {
    /// From 0, which is one eye in the middle.
    ///
    /// # Errors
    ///
    /// [`ViewError::Measure`] unless it is from 0 to 1000 mm.
    pub fn new(distance: Millimetres<T>) -> Result<Self, ViewError> {
        measure(distance).map(Self)
    }

    /// 64 mm, as in algorithm 2.
    pub fn of_the_notes() -> Self {
        Self(Millimetres(convert(64.0)))
    }

    /// The distance.
    pub fn distance(self) -> Millimetres<T> {
        self.0
    }

    /// Where the eye is in the frame of the head, in millimetres.
    pub fn position(self, eye: Eye) -> Point3<T> {
        let half = self.0.0 * convert(0.5);
        match eye {
            Eye::Left => Point3::new(-half, T::zero(), T::zero()),
            Eye::Right => Point3::new(half, T::zero(), T::zero()),
        }
    }

    /// From the frame of the head to that of the eye's camera: T(∓ipd/2, 0, 0), the same as looking
    /// from the eye's position straight along −z ([`look_at`], algorithm 2 line 8).
    pub fn from_head(self, eye: Eye) -> Isometry3<T> {
        Translation3::from(-self.position(eye).coords).into()
    }
}

/// A measure of the wearer.
pub(super) fn measure<T: RealField + Copy>(
    length: Millimetres<T>,
) -> Result<Millimetres<T>, ViewError> {
    // Written so that what is not a number fails.
    if length.0 >= T::zero() && length.0 <= convert(1000.0) {
        Ok(length)
    } else {
        Err(ViewError::Measure)
    }
}

/// OpenGL's look-at: the view from `eye` towards `target`, with `up` upwards in the picture. All
/// three are in the same frame, which the view takes points from; positions in millimetres, the
/// length of `up` plays no part.
///
/// # Errors
///
/// [`ViewError::NoDirection`] if the two points are the same, or `up` is zero, not finite or along
/// the line of sight; [`ViewError::Position`] if a point is not finite or too far away.
pub fn look_at<T: RealField + Copy>(
    eye: Point3<T>,
    target: Point3<T>,
    up: Vector3<T>,
) -> Result<Isometry3<T>, ViewError> {
    let sight = target - eye;
    if !sight.iter().all(|component| component.is_finite()) {
        return Err(ViewError::Position);
    }
    let sight = direction(sight).ok_or(ViewError::NoDirection)?;
    let up = direction(up).ok_or(ViewError::NoDirection)?;
    // Closer to the line of sight than this, the side is rounding.
    if sight.cross(&up).norm() < T::default_epsilon() * convert(64.0) {
        return Err(ViewError::NoDirection);
    }
    let turn = Isometry3::look_at_rh(&Point3::origin(), &Point3::from(sight), &up);
    finite(turn * Translation3::from(-eye.coords))
}

/// A view none of whose numbers overflowed.
pub(super) fn finite<T: RealField + Copy>(view: Isometry3<T>) -> Result<Isometry3<T>, ViewError> {
    if view.translation.vector.iter().all(|t| t.is_finite()) {
        Ok(view)
    } else {
        Err(ViewError::Position)
    }
}
