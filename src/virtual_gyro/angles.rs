//! First method: Tait-Bryan angles (sections 3.1, 3.3 and 3.4).
//!
//! Table 1 of the paper lists attitudes for which eq. 3 and 4 are said to fail, with values for
//! four headings each. Only those with g_d along x_d are singular, and there the heading is
//! continuous; so the table is replaced by two formulas, one for each end of the x axis:
//!
//! * θ = −π/2 (g_dNx = 1): φ + ψ = atan2(−B_dy, −B_dz)
//! * θ = +π/2 (g_dNx = −1): φ − ψ = atan2(B_dy, B_dz)

use super::fields::Directions;
use crate::units::Angle;
use nalgebra::{RealField, Rotation3, Vector3, convert};

/// Closer to ±π/2 than this many roundings, φ and ψ cannot be told apart. Farther away they can:
/// each on its own is imprecise there, but together they make the right attitude.
const LOCKED: f64 = 8.0;

/// What to do where only one angle is left of φ and ψ (section 3.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GimbalLock {
    /// First strategy: all three angles stay as they were. The attitude is then off by whatever
    /// the device turns meanwhile. If there is nothing to keep, as [`GimbalLock::Resolve`].
    Keep,
    /// Second strategy: θ = ±π/2 is known, φ is kept (0 if there is none), and ψ follows. The
    /// attitude is right.
    Resolve,
}

/// Roll φ, pitch θ and yaw ψ of section 3.1: device against north, east and down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaitBryan<T> {
    /// φ about x, −π to π.
    pub roll: Angle<T>,
    /// θ about y, −π/2 to π/2.
    pub pitch: Angle<T>,
    /// ψ about z, −π to π: 0 facing magnetic north, π/2 facing east.
    pub yaw: Angle<T>,
}

impl<T: RealField + Copy> TaitBryan<T> {
    /// φ, θ and ψ in radians, as they come: neither wrapped nor checked.
    pub fn from_rad(roll: T, pitch: T, yaw: T) -> Self {
        Self {
            roll: Angle::from_rad(roll),
            pitch: Angle::from_rad(pitch),
            yaw: Angle::from_rad(yaw),
        }
    }

    /// Eq. 3, 4 and the one for ψ after them. `previous` is what there is to keep.
    ///
    /// θ is taken by atan2, with the denominator of eq. 4 written as the length √(g_dy² + g_dz²)
    /// that it is: never negative, so the range −π/2 to π/2 is kept, and no division by zero.
    pub fn from_directions(
        directions: &Directions<T>,
        gimbal_lock: GimbalLock,
        previous: Option<Self>,
    ) -> Self {
        let (g, b) = (directions.gravity(), directions.magnetic());
        let across = g.y.hypot(g.z);
        if is_locked(across) {
            return match (gimbal_lock, previous) {
                (GimbalLock::Keep, Some(previous)) => previous,
                _ if g.x > T::zero() => Self::nose_down((-b.y).atan2(-b.z), previous),
                _ => Self::nose_up(b.y.atan2(b.z), previous),
            };
        }
        let roll = g.y.atan2(g.z);
        let pitch = (-g.x).atan2(across);
        let (sin_roll, cos_roll) = roll.sin_cos();
        let (sin_pitch, cos_pitch) = pitch.sin_cos();
        let west = b.z * sin_roll - b.y * cos_roll;
        let north = b.x * cos_pitch + (b.y * sin_roll + b.z * cos_roll) * sin_pitch;
        Self::from_rad(roll, pitch, west.atan2(north))
    }

    /// R(φ, θ, ψ) = R_x(φ) R_y(θ) R_z(ψ) of section 3.1, reference to device.
    ///
    /// The paper calls these turns about the axes of the reference frame. They are turns about
    /// the device's own axes, z first, then the new y, then the new x. An angle that is not finite
    /// counts as zero.
    pub fn matrix(&self) -> Rotation3<T> {
        // The paper's factors turn the frame, nalgebra's turn vectors.
        let turn = |axis, angle: Angle<T>| {
            Rotation3::from_axis_angle(&axis, -angle.finite_or_zero().rad())
        };
        turn(Vector3::x_axis(), self.roll)
            * turn(Vector3::y_axis(), self.pitch)
            * turn(Vector3::z_axis(), self.yaw)
    }

    /// θ = −π/2; `sum` is φ + ψ.
    pub(super) fn nose_down(sum: T, previous: Option<Self>) -> Self {
        let roll = kept_roll(previous);
        Self::from_rad(roll, -T::frac_pi_2(), wrapped(sum - roll))
    }

    /// θ = +π/2; `difference` is φ − ψ.
    pub(super) fn nose_up(difference: T, previous: Option<Self>) -> Self {
        let roll = kept_roll(previous);
        Self::from_rad(roll, T::frac_pi_2(), wrapped(roll - difference))
    }
}

fn kept_roll<T: RealField + Copy>(previous: Option<TaitBryan<T>>) -> T {
    previous.map_or(T::zero(), |previous| previous.roll.rad())
}

/// Whether cos θ is nothing but rounding.
pub(super) fn is_locked<T: RealField + Copy>(cos_pitch: T) -> bool {
    cos_pitch < T::default_epsilon() * convert(LOCKED)
}

/// The same angle between −π and π.
pub(super) fn wrapped<T: RealField + Copy>(angle: T) -> T {
    if angle.abs() <= T::pi() {
        return angle;
    }
    angle - T::two_pi() * (angle / T::two_pi()).round()
}
