//! Pitch and roll from the accelerometer alone (course notes, section 4): no drift, and every
//! acceleration of the head shows as a tilt.

use crate::units::{Angle, SpecificForce};
use nalgebra::RealField;

/// The two angles an accelerometer can tell, of yaw about y, then pitch about x, then roll about
/// z: body to world R_y(yaw) R_x(pitch) R_z(roll), the inverse of eq. 10.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PitchRoll<T> {
    /// θ_x, from −90° to 90°.
    pub pitch: Angle<T>,
    /// θ_z, from −180° to 180°.
    pub roll: Angle<T>,
}

/// Eq. 11 and 12 for a force in the body frame; zeros if it is not finite.
///
/// As printed the two do not go together: eq. 11 uses the sign of a_y to reach pitches beyond
/// ±90°, and eq. 12 uses it again, so that for a board with a_y < 0 (pitch 10°, roll 170°) they
/// describe another one. Here roll alone has the full circle, and eq. 11 is taken without the
/// sign. That covers every tilt once, and is the same wherever a_y > 0.
pub fn pitch_and_roll<T: RealField + Copy>(force: SpecificForce<T>) -> PitchRoll<T> {
    let a = force.m_per_s2();
    let or_zero = |angle: T| Angle::from_rad(if angle.is_finite() { angle } else { T::zero() });
    PitchRoll {
        pitch: or_zero(-a.z.atan2((a.x * a.x + a.y * a.y).sqrt())),
        roll: or_zero(-(-a.x).atan2(a.y)),
    }
}
