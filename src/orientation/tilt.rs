//! How far from level (course notes, section 5.2): the accelerometer, rotated into the world,
//! ought to point up; the shortest turn that makes it do so is the correction. It never turns
//! about the vertical, so it leaves yaw alone, of which an accelerometer knows nothing.

use super::rotation::{from_half_angle, renormalised};
use crate::units::SpecificForce;
use nalgebra::{RealField, UnitQuaternion, Vector3, convert};

/// The tilt correction of eq. 23, of which only `fraction` is carried out (eq. 24 asks for 1 − α):
/// q(fraction · φ, n/|n|) with n = v × y = (−v_z, 0, v_x) and φ the angle between v and y.
///
/// `force` is in the **world** frame (eq. 21); its length plays no part. The notes leave three
/// corners open: a force that already points up asks for no correction, where eq. 23 divides zero
/// by zero; one that points down can be turned up about any horizontal axis, and x is taken; one
/// that is zero or not finite says nothing, and nothing is corrected.
pub fn correction<T: RealField + Copy>(force: SpecificForce<T>, fraction: T) -> UnitQuaternion<T> {
    from_half_angle(phi_n(force.m_per_s2()) * (fraction * convert(0.5)))
}

/// Turns `orientation` about a horizontal axis until `force` (**body** frame) points up in the
/// world: full correction, yaw kept. An orientation that is none, which `new_unchecked` lets anyone
/// make, is taken for the identity.
pub fn level<T: RealField + Copy>(
    orientation: UnitQuaternion<T>,
    force: SpecificForce<T>,
) -> UnitQuaternion<T> {
    let orientation = renormalised(orientation);
    correction(in_world(orientation, force), T::one()) * orientation
}

/// Eq. 20 and 21: a force in the body frame as seen from the world. `orientation` is body to
/// world.
///
/// The product q a q⁻¹ is worked out with two cross products instead of two quaternion products:
/// the same vector for half the arithmetic. What is not finite stays so; [`correction`] then
/// corrects nothing.
pub fn in_world<T: RealField + Copy>(
    orientation: UnitQuaternion<T>,
    force: SpecificForce<T>,
) -> SpecificForce<T> {
    SpecificForce::from_m_per_s2(orientation * force.m_per_s2())
}

/// Whether a force points anywhere: it is not zero, and finite.
pub fn has_direction<T: RealField + Copy>(force: SpecificForce<T>) -> bool {
    let v = force.m_per_s2();
    v.iter().all(|component| component.is_finite()) && !v.amax().is_zero()
}

/// φ n/|n| of eq. 23.
fn phi_n<T: RealField + Copy>(v: Vector3<T>) -> Vector3<T> {
    if v.y > T::zero() {
        let per_up = T::one() / v.y;
        let (x, z) = (v.x * per_up, v.z * per_up);
        let t = x * x + z * z; // tan² φ
        if t < convert(1e-2) {
            // Up to 5.7°, where a tracker spends its life: the series of the arc tangent of
            // |n|/v_y, good to 1e-11, for one division and no root. Near level two terms do.
            let c = |denominator: f64| -> T { convert(1.0 / denominator) };
            let series = if t < convert(1e-5) {
                T::one() - t * (c(3.0) - t * c(5.0))
            } else {
                T::one() - t * (c(3.0) - t * (c(5.0) - t * (c(7.0) - t * c(9.0))))
            };
            return Vector3::new(-z * series, T::zero(), x * series);
        }
    }
    phi_n_anywhere(v)
}

/// The same for any v, with φ = atan2(√(v_x² + v_z²), v_y) for eq. 23's cos⁻¹(v_y): the same
/// angle, but an arc cosine loses half its digits near zero.
fn phi_n_anywhere<T: RealField + Copy>(v: Vector3<T>) -> Vector3<T> {
    if !has_direction(SpecificForce::from_m_per_s2(v)) {
        return Vector3::zeros();
    }
    let largest = v.amax();
    // The largest component becomes ±1, so that the squares neither overflow nor all vanish.
    let u = v / largest;
    let length = (u.x * u.x + u.z * u.z).sqrt();
    if !length.is_zero() {
        let phi_per_length = length.atan2(u.y) / length;
        Vector3::new(-u.z, T::zero(), u.x) * phi_per_length
    } else if u.y < T::zero() {
        Vector3::x() * T::pi()
    } else {
        Vector3::zeros()
    }
}
