//! `glRotatef(angle, axisX, axisY, axisZ)` of the course notes' algorithms 1–3: an angle in
//! **degrees** and an axis, made a 4×4 matrix. Algorithm 1 turns a test object with it, exactly as
//! the board is turned; the angle and the axis are those of
//! [`axis_angle`](crate::orientation::quaternion::axis_angle).
//!
//! The notes' `quatToAxisAngle` is eq. 36, which gives radians, and `glRotatef` next to it takes
//! degrees. Here the angle is an [`Angle`] and cannot be mistaken.

use super::ViewError;
use crate::orientation::quaternion::from_axis_angle;
use crate::units::Angle;
use nalgebra::{Matrix4, RealField, Vector3};

/// The 4×4 matrix of a turn by `angle` about `axis`, counter-clockwise as seen from the axis' tip.
/// As with OpenGL's, the length of the axis plays no part.
///
/// # Errors
///
/// [`ViewError::NoAngle`] if the angle is not finite, [`ViewError::NoAxis`] if the axis is zero or
/// not finite.
pub fn gl_rotate<T: RealField + Copy>(
    angle: Angle<T>,
    axis: Vector3<T>,
) -> Result<Matrix4<T>, ViewError> {
    if !angle.rad().is_finite() {
        return Err(ViewError::NoAngle);
    }
    let turn = from_axis_angle(axis, angle).ok_or(ViewError::NoAxis)?;
    Ok(turn.to_homogeneous())
}
