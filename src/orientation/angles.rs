//! Pitch and roll from the accelerometer alone (course notes, section 4; both lectures): no drift,
//! and every acceleration of the head shows as a tilt.
//!
//! Every direction of the force belongs to two pairs of angles: pitch p and roll r, and pitch π − p
//! and roll π + r. The documents give two formulas for pitch, of which each belongs to another pair,
//! and one for roll:
//!
//! | pitch | its range | the roll that goes with it | together |
//! |---|---|---|---|
//! | [`pitch_half_circle`], 2016 lecture, first form | ±90° | eq. 12, atan2 | [`pitch_and_roll`] |
//! | [`pitch_full_circle`], eq. 11 with sign(a_y) | ±180° | ±90°, tan⁻¹ | [`full_pitch_and_roll`] |
//!
//! As printed, eq. 11 *with* the sign and eq. 12 *with* atan2 stand side by side, and for a_y < 0
//! describe another board: both use the sign of a_y to reach the other half of the sphere, and
//! together they come back.

use crate::units::{Angle, SpecificForce};
use nalgebra::{RealField, Vector3};

/// The two angles an accelerometer can tell, of yaw about y, then pitch about x, then roll about
/// z: body to world R_y(yaw) R_x(pitch) R_z(roll), the inverse of eq. 10.
///
/// (The text of section 4 names yaw, pitch and roll as turns about y, z and x. Its equations, and
/// everything here, have them about y, x and z.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PitchRoll<T> {
    /// θ_x about x: looking up is positive.
    pub pitch: Angle<T>,
    /// θ_z about z: leaning to the left is positive.
    pub roll: Angle<T>,
}

impl<T: RealField + Copy> PitchRoll<T> {
    /// Eq. 10: the direction the accelerometer of a resting board reads, body frame, of length 1.
    /// Yaw has no part in it. An angle that is not finite counts as zero.
    pub fn up_in_body(&self) -> Vector3<T> {
        let (sin_x, cos_x) = self.pitch.finite_or_zero().rad().sin_cos();
        let (sin_z, cos_z) = self.roll.finite_or_zero().rad().sin_cos();
        Vector3::new(cos_x * sin_z, cos_x * cos_z, -sin_x)
    }
}

/// Pitch from −90° to 90° and roll from −180° to 180°: the pair the other modules use, since the
/// pitch of a head stays in that range. Straight up or down, where every roll would do, roll is
/// zero. Zeros for a force (body frame) that has no direction.
pub fn pitch_and_roll<T: RealField + Copy>(force: SpecificForce<T>) -> PitchRoll<T> {
    or_zeros(directed(force).map(|a| PitchRoll {
        pitch: half_circle(a),
        roll: if horizontal_is_zero(a) {
            Angle::from_rad(T::zero())
        } else {
            Angle::from_rad(-(-a.x).atan2(a.y))
        },
    }))
}

/// Pitch from −180° to 180° (eq. 11) and roll from −90° to 90°. Zeros for a force (body frame) that
/// has no direction.
///
/// Eq. 12 in its other form, tan⁻¹(a_x/a_y), without the division by a_y.
pub fn full_pitch_and_roll<T: RealField + Copy>(force: SpecificForce<T>) -> PitchRoll<T> {
    or_zeros(directed(force).map(|a| PitchRoll {
        pitch: full_circle(a),
        roll: Angle::from_rad((sign(a.y) * a.x).atan2(a.y.abs())),
    }))
}

/// θ_x = −atan2(a_z, √(a_x² + a_y²)), from −90° to 90° (2016 lecture, first form): the elevation of
/// the body's −z above the horizon. Zero for a force (body frame) that has no direction.
pub fn pitch_half_circle<T: RealField + Copy>(force: SpecificForce<T>) -> Angle<T> {
    directed(force).map_or(Angle::from_rad(T::zero()), half_circle)
}

/// Eq. 11: θ_x = −atan2(a_z, sign(a_y) √(a_x² + a_y²)), from −180° to 180°. Zero for a force (body
/// frame) that has no direction.
///
/// The sign of zero is taken as +1. As 0 it would make every pitch with a_y = 0 one of ±90°.
pub fn pitch_full_circle<T: RealField + Copy>(force: SpecificForce<T>) -> Angle<T> {
    directed(force).map_or(Angle::from_rad(T::zero()), full_circle)
}

fn half_circle<T: RealField + Copy>(a: Vector3<T>) -> Angle<T> {
    Angle::from_rad(-a.z.atan2(across(a)))
}

fn full_circle<T: RealField + Copy>(a: Vector3<T>) -> Angle<T> {
    Angle::from_rad(-a.z.atan2(sign(a.y) * across(a)))
}

/// √(a_x² + a_y²).
fn across<T: RealField + Copy>(a: Vector3<T>) -> T {
    (a.x * a.x + a.y * a.y).sqrt()
}

/// The board points straight up or down, where every roll would do.
fn horizontal_is_zero<T: RealField + Copy>(a: Vector3<T>) -> bool {
    a.x.is_zero() && a.y.is_zero()
}

fn sign<T: RealField + Copy>(x: T) -> T {
    if x < T::zero() { -T::one() } else { T::one() }
}

/// The force with its largest component made ±1, so that squares neither overflow nor vanish. None
/// if it is zero or not finite.
fn directed<T: RealField + Copy>(force: SpecificForce<T>) -> Option<Vector3<T>> {
    let a = force.m_per_s2();
    let largest = a.amax();
    let finite = a.iter().all(|component| component.is_finite());
    (finite && !largest.is_zero()).then(|| a / largest)
}

fn or_zeros<T: RealField + Copy>(found: Option<PitchRoll<T>>) -> PitchRoll<T> {
    let zero = Angle::from_rad(T::zero());
    found.unwrap_or(PitchRoll {
        pitch: zero,
        roll: zero,
    })
}
