//! The attitude as a quaternion, **device to reference** (sections 3.5, 3.6, 4.2 and 4.3).
//!
//! The paper writes (q₁ q₂ q₃ q₄) with the scalar last; that is the order of nalgebra's `coords`.
//! Product, inverse and rotation (eq. 5 and 6) are nalgebra's. The conjugate is the inverse of a
//! unit quaternion only.

use super::angles::{TaitBryan, is_locked, wrapped};
use crate::orientation::quaternion::trued;
use nalgebra::{Quaternion, RealField, Rotation3, UnitQuaternion, Vector3, convert};

/// q = q_ψ q_θ q_φ of section 3.6.
///
/// With the product of eq. 5 and the matrices of section 3.1 the factors stand in this order. The
/// printed one, q_φ q_θ q_ψ, is neither this attitude nor its inverse. An angle that is not finite
/// counts as zero.
pub fn from_angles<T: RealField + Copy>(angles: &TaitBryan<T>) -> UnitQuaternion<T> {
    let q_phi =
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angles.roll.finite_or_zero().rad());
    let q_theta =
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angles.pitch.finite_or_zero().rad());
    let q_psi =
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angles.yaw.finite_or_zero().rad());
    q_psi * q_theta * q_phi
}

/// Table 2: q from M (reference to device). None if M is not finite or has elements that no
/// rotation has.
///
/// Each of the four components can be had from a root; the case is that of the largest of them,
/// so that every matrix has one and the root is never below 1, equal components and half turns
/// included. Conditions by strict inequality leave gaps there. The sign of q is that of the case,
/// and jumps from one to the next: see [`super::angular_velocity::nearer`].
pub fn from_matrix<T: RealField + Copy>(matrix: &Rotation3<T>) -> Option<UnitQuaternion<T>> {
    let m = matrix.matrix();
    if !m.iter().all(|element| element.abs() <= convert(2.0)) {
        return None;
    }
    let one = T::one();
    let (m11, m22, m33) = (m.m11, m.m22, m.m33);
    // 4 q₁², 4 q₂², 4 q₃², 4 q₄², which add up to 4.
    let squares = [
        one + m11 - m22 - m33,
        one - m11 + m22 - m33,
        one - m11 - m22 + m33,
        one + m11 + m22 + m33,
    ];
    let [s1, s2, s3, s4] = squares;
    let (xy, zx, yz) = (m.m12 + m.m21, m.m31 + m.m13, m.m23 + m.m32);
    let (x, y, z) = (m.m23 - m.m32, m.m31 - m.m13, m.m12 - m.m21);
    // Each row is 4 q times the component it is the case of.
    let [q1, q2, q3, q4] = if s4 >= s1 && s4 >= s2 && s4 >= s3 {
        [x, y, z, s4]
    } else if s1 >= s2 && s1 >= s3 {
        [s1, xy, zx, x]
    } else if s2 >= s3 {
        [xy, s2, yz, y]
    } else {
        [zx, yz, s3, z]
    };
    UnitQuaternion::try_new(Quaternion::new(q4, q1, q2, q3), T::default_epsilon())
}

/// Section 4.3: φ, θ and ψ of a quaternion. At θ = ±π/2 the φ of `previous` is kept (0 if there
/// is none), and ψ follows from it.
///
/// The paper's formulas lose their digits where θ comes near ±π/2, in the arc sine and in both
/// arc tangents. The same angles come from half sums, which do not:
/// tan((φ − ψ)/2) = (q₁ − q₃)/(q₄ + q₂) and tan((φ + ψ)/2) = (q₁ + q₃)/(q₄ − q₂), where the
/// hypotenuses are cos(θ/2) ± sin(θ/2). (The paper keeps θ at the singularity; but θ is known.)
///
/// A quaternion that is zero or not finite counts as the identity.
pub fn to_angles<T: RealField + Copy>(
    q: &UnitQuaternion<T>,
    previous: Option<TaitBryan<T>>,
) -> TaitBryan<T> {
    let q = trued(*q);
    let (q1, q2, q3, q4) = (q.i, q.j, q.k, q.w);
    let half = |sine: T, cosine: T| (sine.hypot(cosine), sine.atan2(cosine));
    let (plus, half_difference) = half(q1 - q3, q4 + q2);
    let (minus, half_sum) = half(q1 + q3, q4 - q2);
    if is_locked(minus) {
        return TaitBryan::nose_up(half_difference * convert(2.0), previous);
    }
    if is_locked(plus) {
        return TaitBryan::nose_down(half_sum * convert(2.0), previous);
    }
    TaitBryan::from_rad(
        wrapped(half_sum + half_difference),
        plus.atan2(minus) * convert(2.0) - T::frac_pi_2(),
        wrapped(half_sum - half_difference),
    )
}
