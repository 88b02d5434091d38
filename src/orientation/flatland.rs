//! One angle (course notes, section 3): roll about z, by the gyro, by the accelerometer, and by
//! both. It is the whole idea of the complementary filter in three lines of arithmetic.

use super::TimeConstant;
use crate::calibration::Reading;
use crate::units::{Angle, Seconds, SpecificForce};
use nalgebra::RealField;

pub mod error;

pub mod response;

/// Three estimates of the same angle, each from −180° to 180° so that they can be plotted on top
/// of each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roll<T> {
    /// Eq. 7: smooth, and drifting.
    pub gyro: Angle<T>,
    /// Eq. 8: right on average, and noisy.
    pub accelerometer: Angle<T>,
    /// Eq. 9: neither.
    pub fused: Angle<T>,
}

/// The flatland filter: the world is the x–y plane, and the board turns in it.
#[derive(Clone, Copy, Debug)]
pub struct Flatland<T> {
    sample_period: Seconds<T>,
    /// 1 − α of eq. 9.
    accelerometer_weight: T,
    roll: Roll<T>,
}

impl<T: RealField + Copy> Flatland<T> {
    /// Starts from zero.
    pub fn new(time_constant: TimeConstant<T>, sample_period: Seconds<T>) -> Self {
        let zero = Angle::from_rad(T::zero());
        Self {
            sample_period,
            accelerometer_weight: time_constant.accelerometer_weight(sample_period),
            roll: Roll {
                gyro: zero,
                accelerometer: zero,
                fused: zero,
            },
        }
    }

    /// Starts again from a chosen angle: θ(0) of section 3.1. Zero if it is not finite.
    pub fn start_at(&mut self, angle: Angle<T>) {
        let start = wrapped_or(angle.rad(), Angle::from_rad(T::zero()));
        self.roll = Roll {
            gyro: start,
            accelerometer: start,
            fused: start,
        };
    }

    /// Starts again from the accelerometer's angle, the other choice of section 3.1; from zero if
    /// it shows none. `force` is in the body frame.
    pub fn reset(&mut self, force: SpecificForce<T>) {
        self.start_at(from_accelerometer(force).unwrap_or(Angle::from_rad(T::zero())));
    }

    /// One sample. A rate that is not finite turns nothing, and a force without a direction in the
    /// plane corrects nothing.
    pub fn update(&mut self, reading: &Reading<T>) -> Roll<T> {
        let turned = Angle::from_rad(reading.rate().rad_per_s().z * self.sample_period.0);
        let turned = turned.finite_or_zero().rad();
        // Eq. 7.
        let gyro = self.roll.gyro.rad() + turned;
        // Eq. 9. The notes blend the two angles, which across the seam gives nonsense: half way
        // between 179° and −179° is 180°, not 0°. So the difference is wrapped, then blended.
        let by_gyro = self.roll.fused.rad() + turned;
        let accelerometer = from_accelerometer(reading.force());
        let fused = match accelerometer {
            Some(angle) => {
                let missing = shortest_turn(Angle::from_rad(by_gyro), angle);
                by_gyro + self.accelerometer_weight * missing.rad()
            }
            None => by_gyro,
        };
        self.roll = Roll {
            gyro: wrapped_or(gyro, self.roll.gyro),
            accelerometer: accelerometer.unwrap_or(self.roll.accelerometer),
            fused: wrapped_or(fused, self.roll.fused),
        };
        self.roll
    }

    /// As of the last sample.
    pub fn roll(&self) -> Roll<T> {
        self.roll
    }
}

/// Eq. 8: atan2(a_x, a_y), from −180° to 180°. None where the force (body frame) has no direction
/// in the plane, as in free fall.
pub fn from_accelerometer<T: RealField + Copy>(force: SpecificForce<T>) -> Option<Angle<T>> {
    let a = force.m_per_s2();
    let directed = a.x.is_finite() && a.y.is_finite() && !(a.x.is_zero() && a.y.is_zero());
    directed.then(|| Angle::from_rad(a.x.atan2(a.y)))
}

/// The difference between two angles, the short way round: from −180° to 180°. Not finite if one of
/// the angles is not.
pub fn shortest_turn<T: RealField + Copy>(from: Angle<T>, to: Angle<T>) -> Angle<T> {
    Angle::from_rad(wrapped(to.rad() - from.rad()))
}

/// The same angle between −π and π. Not finite if the angle is not.
fn wrapped<T: RealField + Copy>(mut angle: T) -> T {
    // Once is enough for any angle of this world. One so large that its own rounding is more than a
    // turn leaves a rest, smaller by the digits of the scalar; f64::MAX is down after twenty.
    for _ in 0..32 {
        if angle.abs() <= T::pi() {
            break;
        }
        angle -= T::two_pi() * (angle / T::two_pi()).round();
    }
    angle
}

fn wrapped_or<T: RealField + Copy>(angle: T, otherwise: Angle<T>) -> Angle<T> {
    let angle = wrapped(angle);
    if angle.is_finite() {
        Angle::from_rad(angle)
    } else {
        otherwise
    }
}
