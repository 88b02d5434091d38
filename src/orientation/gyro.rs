//! Dead reckoning with the gyro alone (course notes, section 5.1).
//!
//! Smooth and quick, and it drifts for ever: a bias of 0.1 °/s left in the readings is 6° after a
//! minute, in any direction. It is here to be looked at beside the fused orientation.

use super::rotation::{from_half_angle, renormalised};
use crate::calibration::Reading;
use crate::units::{AngularRate, Seconds};
use nalgebra::{RealField, UnitQuaternion, convert};

/// q_Δ of eq. 17: the turn from this sample's body frame to that of the last one, for a body that
/// turned at `rate` (body frame) for the whole of the period. The identity where eq. 17 divides zero
/// by zero, at no rate, and for a turn that is not finite or whose square is not.
///
/// Any other turn, however many times round, is as exact as its angle is: to 1e-5 in `f32` up to
/// twenty turns, after which the rounding of the angle itself is more.
pub fn step<T: RealField + Copy>(rate: AngularRate<T>, period: Seconds<T>) -> UnitQuaternion<T> {
    from_half_angle(rate.rad_per_s() * (period.0 * convert(0.5)))
}

/// Integrates the gyro, and nothing else: eq. 17 and 18.
#[derive(Clone, Copy, Debug)]
pub struct DeadReckoning<T: RealField> {
    sample_period: Seconds<T>,
    orientation: UnitQuaternion<T>,
}

impl<T: RealField + Copy> DeadReckoning<T> {
    /// Starts from the identity, as the notes do.
    pub fn new(sample_period: Seconds<T>) -> Self {
        Self {
            sample_period,
            orientation: UnitQuaternion::identity(),
        }
    }

    /// Starts again from this orientation, body to world; from the identity if it is zero or not
    /// finite.
    pub fn set(&mut self, orientation: UnitQuaternion<T>) {
        self.orientation = renormalised(orientation);
    }

    /// Eq. 18: q ← q q_Δ. On the right, because q_Δ is a turn in the body's own axes. A rate that is
    /// not finite turns nothing.
    pub fn update(&mut self, reading: &Reading<T>) -> UnitQuaternion<T> {
        let q_delta = step(reading.rate(), self.sample_period);
        self.orientation = renormalised(self.orientation * q_delta);
        self.orientation
    }

    /// As of the last sample, body to world.
    pub fn orientation(&self) -> UnitQuaternion<T> {
        self.orientation
    }
}
