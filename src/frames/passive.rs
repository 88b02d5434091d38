//! Active: the vector turns, body to world, u_world = q u_body q⁻¹ (course notes eq. 19 and 33).
//! Passive: the vector stays and is seen from the turned frame, u_d = R u_r (the matrices R and M of
//! the gyroscope-emulation paper, reference to device). One is the inverse of the other.
//!
//! The paper's table 2 has both: it makes of the passive M the quaternion device to reference, an
//! active one. So it is the notes' eq. 34 applied to the transpose of M.

use nalgebra::{Matrix3, RealField, Rotation3, UnitQuaternion, convert};

/// The paper's R or M, reference to device, of an orientation, body to world, in the same axes.
pub fn matrix<T: RealField + Copy>(q: UnitQuaternion<T>) -> Matrix3<T> {
    q.conjugate().to_rotation_matrix().into_inner()
}

/// The orientation, body to world, of the paper's R or M. Of the two quaternions for it, either.
///
/// None if it is not a rotation: an element of MᵀM is more than 1e-3 off, it mirrors, or is not
/// finite.
pub fn orientation<T: RealField + Copy>(
    reference_to_device: Matrix3<T>,
) -> Option<UnitQuaternion<T>> {
    let m = reference_to_device;
    let off = (m.tr_mul(&m) - Matrix3::identity()).abs();
    // Written so that what is not a number fails.
    let orthonormal = off.iter().all(|element| *element < convert(1e-3));
    if !(orthonormal && m.determinant() > T::zero()) {
        return None;
    }
    let active = Rotation3::from_matrix_unchecked(m.transpose());
    let q = UnitQuaternion::from_rotation_matrix(&active);
    Some(UnitQuaternion::new_normalize(q.into_inner()))
}
