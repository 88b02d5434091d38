//! A turn about the vertical, kept beside the inclination: a compass that is wrong turns the picture
//! and corrects no tilt.

use super::disturbance::{Disturbance, FieldVerdict};
use super::parameters::{Parameters, low_pass_weight, share};
use crate::units::{RADIANS_PER_DEGREE, Seconds};
use nalgebra::{Quaternion, RealField, UnitQuaternion, Vector3, convert};

/// The compass.
#[derive(Clone, Copy, Debug)]
pub struct Heading<T: RealField> {
    low_pass: T,
    /// rad/s, squared.
    turning: T,
    disturbance: Disturbance<T>,
    /// Cosine and sine of half the turn about y to north.
    half: [T; 2],
    /// The same of the turn after it, from north to what is to be straight ahead.
    ahead: [T; 2],
    /// Fields since the start, or since the reference changed: the first weigh alike.
    age: u32,
    renewed: u32,
}

/// From this rate on the sensor turns, °/s.
pub const TURNING_DPS: f64 = 20.0;
/// With a new reference the heading goes on as if it had followed it for so long, s.
pub const RENEWED: f64 = 1.0;

impl<T: RealField + Copy> Heading<T> {
    pub fn new(parameters: &Parameters<T>, period: Seconds<T>) -> Self {
        let turning: T = convert(TURNING_DPS * RADIANS_PER_DEGREE);
        Self {
            low_pass: low_pass_weight(parameters.heading_time, period),
            turning: turning * turning,
            disturbance: Disturbance::new(parameters, period),
            half: [T::one(), T::zero()],
            ahead: [T::one(), T::zero()],
            age: 0,
            renewed: super::parameters::samples(Seconds(convert(RENEWED)), period),
        }
    }

    pub fn tune(&mut self, parameters: &Parameters<T>, period: Seconds<T>) {
        self.low_pass = low_pass_weight(parameters.heading_time, period);
        self.disturbance.tune(parameters, period);
    }

    /// One field, µT, in the world of the inclination. Returns the error of the heading before it was
    /// corrected, or none if the field tells nothing: it is disturbed, or has no horizontal part.
    ///
    /// The error is the sine m_x/h of the angle, ±1 beyond a quarter turn. Of it a share of
    /// max(1 − e^(−Δt/τ), 1/n) is corrected.
    pub fn update(&mut self, field: Vector3<T>, rate: Vector3<T>) -> Option<T> {
        let [c, s] = self.half;
        let (cos, sin) = (c * c - s * s, (c + c) * s);
        let x = cos * field.x + sin * field.z;
        let z = cos * field.z - sin * field.x;
        let squared = x * x + z * z;
        let horizontal = squared.sqrt();
        // Below 0.01 µT there is no north.
        if horizontal < convert(0.01) {
            return None;
        }
        let turning = rate.norm_squared() > self.turning;
        let renewed = self.disturbance.update([horizontal, field.y], turning);
        if renewed {
            self.age = self.age.min(self.renewed);
        }
        if self.disturbance.verdict() != FieldVerdict::Undisturbed {
            return None;
        }
        self.age = self.age.saturating_add(1);
        let error = if z > T::zero() {
            T::one().copysign(x)
        } else {
            x / horizontal
        };
        let half = error * self.low_pass.max(share(self.age)) * convert(0.5);
        self.turn_by(half);
        Some(error)
    }

    /// (1, t) after it, as in [`Inclination`](super::inclination::Inclination): a turn by 2 arctan t.
    fn turn_by(&mut self, t: T) {
        let [c, s] = self.half;
        let turned = [c - s * t, s + c * t];
        let squared = turned[0] * turned[0] + turned[1] * turned[1];
        let scale = if (squared - T::one()).abs() > convert(1e-3) {
            T::one() / squared.sqrt()
        } else {
            (convert::<f64, T>(3.0) - squared) * convert(0.5)
        };
        self.half = turned.map(|part| part * scale);
    }

    /// The turn about y, world of the inclination to world.
    pub fn turn(&self) -> UnitQuaternion<T> {
        let [c, s] = after(self.ahead, self.half);
        UnitQuaternion::new_unchecked(Quaternion::new(c, T::zero(), s, T::zero()))
    }

    /// From now on this orientation, body to world of the inclination, looks straight ahead: its own
    /// turn about y is taken back.
    pub fn look_ahead(&mut self, orientation: &UnitQuaternion<T>) {
        let twist = after(self.half, [orientation.w, orientation.j]);
        let length = (twist[0] * twist[0] + twist[1] * twist[1]).sqrt();
        // Upside down there is no turn about y to speak of.
        if length > convert(1e-6) {
            self.ahead = [twist[0] / length, -twist[1] / length];
        }
    }

    pub fn verdict(&self) -> FieldVerdict {
        self.disturbance.verdict()
    }
}

/// A turn about y after another, as cosine and sine of their halves.
fn after<T: RealField + Copy>(second: [T; 2], first: [T; 2]) -> [T; 2] {
    let [[c, s], [d, t]] = [second, first];
    [c * d - s * t, s * d + c * t]
}
