//! Active: the vector turns, body to world, u_world = q u_body q⁻¹ (course notes eq. 19 and 33).
//! Passive: the vector stays and is seen from the turned frame, u_d = R u_r (the matrices R and M of
//! the gyroscope-emulation paper, reference to device). One is the inverse of the other.
//!
//! The paper's table 2 has both: it makes of the passive M the quaternion device to reference, an
//! active one. So it is the notes' eq. 34 applied to the transpose of M.

use crate::orientation::quaternion::{NotARotation, from_matrix, trued};
use nalgebra::{Matrix3, RealField, UnitQuaternion};

/// The paper's R (section 3.1) or M (eq. 7), reference to device, of an orientation, body to world,
/// in the same axes: the transpose of eq. 33 of the notes. A quaternion that is zero or not finite
/// counts as the identity.
pub fn matrix<T: RealField + Copy>(q: UnitQuaternion<T>) -> Matrix3<T> {
    trued(q).conjugate().to_rotation_matrix().into_inner()
}

/// The orientation, body to world, of the paper's R or M (table 2, by way of eq. 34 of the notes),
/// with w ≥ 0.
///
/// # Errors
///
/// See [`from_matrix`]: what is not a rotation is not turned into one.
pub fn orientation<T: RealField + Copy>(
    reference_to_device: Matrix3<T>,
) -> Result<UnitQuaternion<T>, NotARotation> {
    from_matrix(&reference_to_device.transpose())
}
