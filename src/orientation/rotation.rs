//! Rotations given by the vector h = n φ/2, along the axis n and half as long as the angle φ: the
//! only form the estimators need, and one that needs no trigonometric function.
//!
//! On a processor without a floating-point unit sine and cosine cost thousands of instructions,
//! and in libm they compute in double precision whatever they are asked for. All angles here are
//! those of a single sample: small.

use nalgebra::{Quaternion, RealField, UnitQuaternion, Vector3, convert};

/// Up to here, in |h|², four terms of the series leave less than 1e-16. √3 · 2000 °/s for a
/// millisecond, the most a sensor can report, is 9.2e-4.
const SMALL: f64 = 1e-3;

/// q(φ, n) of eq. 13: cos |h| + sin |h| · h/|h|. The identity if |h|² is not finite.
pub(super) fn from_half_angle<T: RealField + Copy>(h: Vector3<T>) -> UnitQuaternion<T> {
    let squared = h.norm_squared();
    if squared < convert(SMALL) {
        series(h, squared)
    } else if squared.is_finite() {
        by_halving(h)
    } else {
        UnitQuaternion::identity()
    }
}

/// The series of cos x and of sin x / x in x² = |h|². No division by |h|, so h = 0 needs no care.
fn series<T: RealField + Copy>(h: Vector3<T>, squared: T) -> UnitQuaternion<T> {
    let x2 = squared;
    let c = |denominator: f64| -> T { convert(1.0 / denominator) };
    // Where x⁴/24 is lost in rounding, two terms are exact: in single precision that is every turn
    // below 3300 °/s at 1 kHz, so the board hardly ever computes more.
    let (cos, sin_over_x) = if x2 * x2 < T::default_epsilon() * convert(6.0) {
        (T::one() - x2 * c(2.0), T::one() - x2 * c(6.0))
    } else {
        (
            T::one() - x2 * (c(2.0) - x2 * (c(24.0) - x2 * c(720.0))),
            T::one() - x2 * (c(6.0) - x2 * (c(120.0) - x2 * c(5040.0))),
        )
    };
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, h * sin_over_x))
}

/// For angles larger than a sample's: a rotation is two of half its angle in a row. Every halving
/// costs one bit of the angle's precision, 6 for half a turn, 7 for the most there is.
fn by_halving<T: RealField + Copy>(h: Vector3<T>) -> UnitQuaternion<T> {
    let mut halvings = 0;
    let mut h = within_a_turn(h);
    let mut squared = h.norm_squared();
    while squared >= convert(SMALL) {
        h *= convert::<f64, T>(0.5);
        squared = h.norm_squared();
        halvings += 1;
    }
    let mut q = series(h, squared);
    for _ in 0..halvings {
        // Doubling the angle squares the norm, so an error left in it would grow like 2^2^n.
        q = renormalised(q * q);
    }
    q
}

/// h with |h| ≤ π and the same sine and cosine, so the same quaternion to its sign. The remainder
/// itself is exact: what it is off by is no more than |h| was rounded by.
fn within_a_turn<T: RealField + Copy>(h: Vector3<T>) -> Vector3<T> {
    let length = h.norm();
    if length <= T::pi() {
        return h;
    }
    let rest = length % T::two_pi();
    let nearer = if rest > T::pi() {
        rest - T::two_pi()
    } else {
        rest
    };
    h * (nearer / length)
}

/// Back to unit length, which rounding has left by a little (the notes' section 5.4 asks for it).
///
/// One Newton step for 1/√n, n = |q|²: q (3 − n)/2, free of division and square root. It leaves
/// 3/8 (n − 1)², so from further away, which no update here comes, the full way is taken. What
/// has no length at all becomes the identity.
pub(super) fn renormalised<T: RealField + Copy>(q: UnitQuaternion<T>) -> UnitQuaternion<T> {
    let q = q.into_inner();
    let n = q.norm_squared();
    if (n - T::one()).abs() < convert(1e-5) {
        return UnitQuaternion::new_unchecked(q * (convert::<f64, T>(1.5) - n * convert(0.5)));
    }
    finite_unit(q).unwrap_or_else(UnitQuaternion::identity)
}

/// The rotation whose quaternion points the same way. None where there is no way to point: at
/// zero, and at what is not finite.
pub(super) fn finite_unit<T: RealField + Copy>(q: Quaternion<T>) -> Option<UnitQuaternion<T>> {
    let largest = q.coords.amax();
    let finite = q.coords.iter().all(|component| component.is_finite());
    if !finite || largest.is_zero() {
        return None;
    }
    // The largest component becomes ±1, so that the square neither overflows nor vanishes.
    let scaled = q / largest;
    let length = scaled.norm_squared().sqrt();
    Some(UnitQuaternion::new_unchecked(scaled / length))
}
