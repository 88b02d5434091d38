//! A rotation as `glRotatef` takes it (course notes, algorithms 1–3): an angle in **degrees**, and
//! an axis. Algorithm 1 turns a test object with it, exactly as the board is turned.
//!
//! The notes' `quatToAxisAngle` is eq. 36, which gives radians, and `glRotatef` next to it takes
//! degrees. Here the angle is an [`Angle`] and cannot be mistaken. Eq. 36 also divides zero by zero
//! at the identity and goes the long way round where q_w < 0.

use super::{ViewError, direction, unit};
use crate::units::Angle;
use nalgebra::{Matrix4, RealField, Rotation3, Unit, UnitQuaternion, Vector3, convert};

/// An axis and the angle of the turn about it, counter-clockwise as seen from the axis' tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisAngle<T: RealField> {
    angle: Angle<T>,
    axis: Unit<Vector3<T>>,
}

impl<T: RealField + Copy> AxisAngle<T> {
    /// From the arguments of `glRotatef`; as there, the length of the axis plays no part.
    ///
    /// # Errors
    ///
    /// [`ViewError::NoAxis`] if the axis is zero or not finite, [`ViewError::NoAngle`] if the angle
    /// is not finite.
    pub fn new(angle: Angle<T>, axis: Vector3<T>) -> Result<Self, ViewError> {
        if !angle.rad().is_finite() {
            return Err(ViewError::NoAngle);
        }
        let axis = direction(axis).ok_or(ViewError::NoAxis)?;
        Ok(Self {
            angle,
            axis: Unit::new_unchecked(axis),
        })
    }

    /// Eq. 36, the short way: the angle is from 0° to 180°. The identity has no axis of its own
    /// and gets x.
    ///
    /// The angle is 2 atan2(|(q_x, q_y, q_z)|, |q_w|) instead of 2 cos⁻¹(q_w): the same, and as good
    /// near zero as anywhere.
    ///
    /// # Errors
    ///
    /// [`ViewError::NotARotation`] if the quaternion is zero or not finite.
    pub fn from_quaternion(q: UnitQuaternion<T>) -> Result<Self, ViewError> {
        let q = unit(q)?;
        let v = if q.w < T::zero() { -q.imag() } else { q.imag() };
        let Some(axis) = direction(v) else {
            return Ok(Self {
                angle: Angle::from_rad(T::zero()),
                axis: Vector3::x_axis(),
            });
        };
        let half = v.dot(&axis).atan2(q.w.abs());
        Ok(Self {
            angle: Angle::from_rad(half * convert(2.0)),
            axis: Unit::new_unchecked(axis),
        })
    }

    /// The angle; [`Angle::degrees`] is what `glRotatef` takes.
    pub fn angle(self) -> Angle<T> {
        self.angle
    }

    /// The axis, of unit length.
    pub fn axis(self) -> Unit<Vector3<T>> {
        self.axis
    }

    /// The inverse rotation: the angle's sign flipped, `glRotatef(-angle, …)` of section 5.4.2.
    pub fn inverse(self) -> Self {
        Self {
            angle: Angle::from_rad(-self.angle.rad()),
            axis: self.axis,
        }
    }

    /// The 4×4 matrix `glRotatef` multiplies by.
    pub fn matrix(self) -> Matrix4<T> {
        Rotation3::from_axis_angle(&self.axis, self.angle.rad()).to_homogeneous()
    }
}
