//! Three ways to the same matrix (course notes, section 5.4.2): to turn the world round the viewer,
//! apply the inverse of the turn that the head made. For a rotation R(q), body to world, each of
//! these is R⁻¹, world to body, the view matrix of lecture 004. All fail alike, with
//! [`ViewError::NotARotation`], if the quaternion is zero or not finite.

use super::gl_rotate::gl_rotate;
use super::{ViewError, unit};
use crate::orientation::quaternion::axis_angle;
use crate::units::Angle;
use nalgebra::{Matrix4, RealField, UnitQuaternion};

/// By flipping the sign of the angle: the notes' `glRotatef(-angle, axisX, axisY, axisZ)`.
///
/// # Errors
///
/// See the module.
pub fn by_flipped_angle<T: RealField + Copy>(
    q: UnitQuaternion<T>,
) -> Result<Matrix4<T>, ViewError> {
    let turn = axis_angle(unit(q)?);
    gl_rotate(Angle::from_rad(-turn.angle.rad()), turn.axis.into_inner())
}

/// By the conjugate (eq. 28), which is the inverse (eq. 29) of a quaternion of unit length; then
/// eq. 33.
///
/// # Errors
///
/// See the module.
pub fn by_conjugate<T: RealField + Copy>(q: UnitQuaternion<T>) -> Result<Matrix4<T>, ViewError> {
    Ok(unit(q)?.conjugate().to_homogeneous())
}

/// By eq. 33, and the inverse of that matrix as of any other: the dearest of the three.
///
/// # Errors
///
/// See the module.
pub fn by_matrix<T: RealField + Copy>(q: UnitQuaternion<T>) -> Result<Matrix4<T>, ViewError> {
    let matrix = unit(q)?.to_homogeneous();
    matrix.try_inverse().ok_or(ViewError::NotARotation)
}
