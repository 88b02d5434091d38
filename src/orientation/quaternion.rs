//! Quaternion algebra (course notes, section 5 and appendix A) on nalgebra's types, with the
//! corners the notes leave open.
//!
//! | notes | here |
//! |---|---|
//! | eq. 14, 27 the vector quaternion of u | `Quaternion::from_imag(u)` |
//! | eq. 25 i, j, k; eq. 30 q + p; eq. 31 qp | `+` and `*` of `Quaternion` |
//! | eq. 26 unit length | [`unit()`], `Quaternion::norm` |
//! | eq. 28 the conjugate | `Quaternion::conjugate`; of a unit quaternion it is the inverse |
//! | eq. 29 the inverse | [`inverse`] |
//! | eq. 13, 35 from axis and angle | [`from_axis_angle`] |
//! | eq. 36 to axis and angle | [`axis_angle`] |
//! | eq. 15, 37 q u q⁻¹ | `UnitQuaternion * Vector3` |
//! | eq. 38 q⁻¹ u q | `UnitQuaternion::inverse_transform_vector` |
//! | eq. 16, 39 q₁ first, then q₂ | `q2 * q1` |
//! | eq. 33 to a matrix | `UnitQuaternion::to_rotation_matrix` |
//! | eq. 34 from a matrix | [`from_matrix`] |
//! | section 5: “interpolate them” | [`slerp`] |
//!
//! A `Quaternion` is any four numbers; a `UnitQuaternion` is a rotation, and [`unit()`] is the door
//! from one to the other. Eq. 15, 33 and 37 hold for unit quaternions only: eq. 33 scales its
//! matrix by |q|².
//!
//! q and −q are the same rotation. Where a function has to choose, it takes the one with w ≥ 0,
//! which is the shorter way round; of a half turn (w = 0) the one whose first component that is
//! not zero is positive.

use super::rotation::{finite_unit, renormalised};
use crate::units::Angle;
use core::fmt;
use nalgebra::{Matrix3, Quaternion, RealField, Unit, UnitQuaternion, Vector3, convert};

/// How far an element of RᵀR may be from that of the unit matrix for R still to pass as a
/// rotation: an element sent with three decimals, or the rounding of any arithmetic, is well
/// within.
const ORTHONORMAL: f64 = 5e-3;

/// A turn by an angle about an axis: θ and v of eq. 13, 35 and 36.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisAngle<T: RealField> {
    /// v, of unit length.
    pub axis: Unit<Vector3<T>>,
    /// θ, counter-clockwise for one who looks against the axis.
    pub angle: Angle<T>,
}

/// Why a matrix is not one of a rotation, so that eq. 34 does not hold for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotARotation {
    /// Its columns are not of unit length and at right angles (or not even numbers).
    NotOrthonormal,
    /// Its determinant is −1: it turns a right hand into a left one.
    Mirrored,
}

impl fmt::Display for NotARotation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotOrthonormal => {
                "not a rotation: the columns must be of unit length and at right angles"
            }
            Self::Mirrored => "not a rotation but a mirror image: exchange two axes or negate one",
        })
    }
}

impl core::error::Error for NotARotation {}

/// q/‖q‖ (eq. 26), of any length that is not zero. None for zero and for what is not finite.
pub fn unit<T: RealField + Copy>(q: Quaternion<T>) -> Option<UnitQuaternion<T>> {
    finite_unit(q)
}

/// What claims to be of unit length, which `new_unchecked` lets anything, made so. The identity for
/// zero and for what is not finite.
pub(crate) fn trued<T: RealField + Copy>(q: UnitQuaternion<T>) -> UnitQuaternion<T> {
    renormalised(q)
}

/// q⁻¹ = q*/‖q‖² of eq. 29, for a quaternion of any length. None for zero, for what is not
/// finite, and where the inverse would be too large for a number.
pub fn inverse<T: RealField + Copy>(q: Quaternion<T>) -> Option<Quaternion<T>> {
    let direction = finite_unit(q)?.into_inner();
    // ‖q‖ over its largest component, whose square neither overflows nor vanishes. Twice divided,
    // for the product of the two could overflow where the quotient does not.
    let largest = q.coords.amax();
    let length = (q / largest).norm();
    let inverse = direction.conjugate() / length / largest;
    is_finite(&inverse).then_some(inverse)
}

/// q(θ, v) of eq. 13 and 35. The axis may have any length; None if it has none, or if the axis or
/// the angle is not finite.
pub fn from_axis_angle<T: RealField + Copy>(
    axis: Vector3<T>,
    angle: Angle<T>,
) -> Option<UnitQuaternion<T>> {
    let v = finite_unit(Quaternion::from_imag(axis))?.imag();
    if !angle.rad().is_finite() {
        return None;
    }
    let (sin, cos) = (angle.rad() * convert(0.5)).sin_cos();
    Some(renormalised(UnitQuaternion::new_unchecked(
        Quaternion::from_parts(cos, v * sin),
    )))
}

/// Eq. 36 the short way: an angle from 0 to π, and the same for q and −q.
///
/// The printed form goes the long way round for q_w < 0, is not a number where rounding makes
/// |q_w| > 1, divides zero by zero at the identity, and of a small angle in single precision keeps
/// half the digits, as every arc cosine does. Here θ/2 = atan2(‖(x, y, z)‖, w). The identity has
/// no axis: its angle is 0, about x; and so is that of what is zero or not finite.
pub fn axis_angle<T: RealField + Copy>(q: UnitQuaternion<T>) -> AxisAngle<T> {
    let q = short_way(renormalised(q));
    let v = q.imag();
    let largest = v.amax();
    if largest.is_zero() {
        return AxisAngle {
            axis: Vector3::x_axis(),
            angle: Angle::from_rad(T::zero()),
        };
    }
    let scaled = v / largest;
    let length = scaled.norm();
    AxisAngle {
        axis: Unit::new_unchecked(scaled / length),
        angle: Angle::from_rad((length * largest).atan2(q.w) * convert(2.0)),
    }
}

/// Eq. 34 for any rotation, with w ≥ 0.
///
/// The printed form divides by q_w, which is zero at every half turn. The four squares 4w², 4x²,
/// 4y², 4z² can all be read off the diagonal; the largest is at least 1, and dividing by its root
/// is always safe. The matrix may be off by rounding: what comes back is of unit length.
///
/// # Errors
///
/// [`NotARotation`] says what is wrong with a matrix that is further off, or not finite.
pub fn from_matrix<T: RealField + Copy>(r: &Matrix3<T>) -> Result<UnitQuaternion<T>, NotARotation> {
    let deviation = r.transpose() * r - Matrix3::identity();
    // Not a number is not within either.
    let within = |element: &T| element.abs() <= convert(ORTHONORMAL);
    if !deviation.iter().all(within) {
        return Err(NotARotation::NotOrthonormal);
    }
    if r.determinant() < T::zero() {
        return Err(NotARotation::Mirrored);
    }
    let [x, y, z] = [r[(0, 0)], r[(1, 1)], r[(2, 2)]];
    let one = T::one();
    // Four times the squares of w, x, y, z; then each row is q times four times its largest.
    let squares = [
        one + x + y + z,
        one + x - y - z,
        one - x + y - z,
        one - x - y + z,
    ];
    let sum = |i, j| r[(i, j)] + r[(j, i)];
    let difference = |i, j| r[(i, j)] - r[(j, i)];
    let rows = [
        [
            squares[0],
            difference(2, 1),
            difference(0, 2),
            difference(1, 0),
        ],
        [difference(2, 1), squares[1], sum(0, 1), sum(0, 2)],
        [difference(0, 2), sum(0, 1), squares[2], sum(1, 2)],
        [difference(1, 0), sum(0, 2), sum(1, 2), squares[3]],
    ];
    let mut largest = rows[0];
    let mut square = squares[0];
    for (row, candidate) in rows.iter().zip(squares) {
        if candidate > square {
            (largest, square) = (*row, candidate);
        }
    }
    let [w, x, y, z] = largest;
    let q = finite_unit(Quaternion::new(w, x, y, z)).ok_or(NotARotation::NotOrthonormal)?;
    Ok(short_way(q))
}

/// From `from` to `to` by an even turn the short way: `fraction` 0 is `from`, 1 is `to` (or −`to`,
/// the same rotation); outside of that the nearer end, and `from` if it is not a number.
///
/// Two orientations half a turn apart have no shorter way; the axis is then that of
/// [`axis_angle`]. One that is zero or not finite counts as the identity.
pub fn slerp<T: RealField + Copy>(
    from: UnitQuaternion<T>,
    to: UnitQuaternion<T>,
    fraction: T,
) -> UnitQuaternion<T> {
    let from = renormalised(from);
    let turn = axis_angle(from.inverse() * renormalised(to));
    let fraction = if fraction > T::zero() {
        fraction.min(T::one())
    } else {
        T::zero()
    };
    let part = Angle::from_rad(turn.angle.rad() * fraction);
    let part = from_axis_angle(turn.axis.into_inner(), part).unwrap_or(UnitQuaternion::identity());
    renormalised(from * part)
}

/// Of q and −q the one that is the same for both.
fn short_way<T: RealField + Copy>(q: UnitQuaternion<T>) -> UnitQuaternion<T> {
    let first = [q.w, q.i, q.j, q.k].into_iter().find(|c| !c.is_zero());
    if first.is_some_and(|component| component < T::zero()) {
        UnitQuaternion::new_unchecked(-q.into_inner())
    } else {
        q
    }
}

fn is_finite<T: RealField + Copy>(q: &Quaternion<T>) -> bool {
    q.coords.iter().all(|component| component.is_finite())
}
