//! One estimator per file, in the order the course notes arrive at them:
//!
//! | file | notes | knows | lacks |
//! |---|---|---|---|
//! | `flatland` | section 3, eq. 6–9 | one angle, from both sensors | the other two |
//! | `angles` | section 4, eq. 10–12 | pitch and roll, from the accelerometer | yaw, and calm |
//! | `euler` | section 4, eq. 10; 2016 lecture | all three, as long as they hardly turn at once | how turns combine |
//! | `quaternion` | section 5, eq. 13–16; appendix A | how rotations are reckoned with | |
//! | `accelerometer` | section 5.2, figure 7 | tilt, from the accelerometer | yaw, and calm |
//! | `gyro` | section 5.1, eq. 17–18 | all three, from the gyro | an end to its drift |
//! | `tilt` | section 5.2, eq. 20–23 | how far from level the gyro has drifted | yaw |
//! | `complementary` | section 5.3, eq. 24 | all three, tilt without drift | a reference for yaw |
//! | `yaw` | blog post | how far from north the heading has drifted | tilt |
//! | `drift` | blog post | all three, with a magnetometer none drifts | |
//!
//! The last two follow the post “Headset Tracking for VR/AR”, which takes the same path as the
//! notes and goes on to the magnetometer.
//!
//! Every estimator keeps three things apart: what a person chooses (a time constant, the
//! sample period), what follows from it, and the state that evolves.

use crate::units::Seconds;
use nalgebra::RealField;

pub mod flatland;

pub mod angles;

pub mod euler;

pub mod quaternion;

pub mod accelerometer;

pub mod gyro;

pub mod tilt;

pub mod complementary;

pub mod yaw;

pub mod drift;

mod rotation;

/// How long a complementary filter trusts the gyro before the accelerometer has had its say: an
/// error of tilt decays to 1/e in this time.
///
/// The notes give the gyro's weight α per sample instead, 0 ≤ α ≤ 1. A weight means nothing
/// without a sample rate, a time does: α = τ/(τ + Δt), so τ = αΔt/(1 − α). (The sentence before
/// eq. 24, that α “defines how aggressively tilt correction is being applied”, describes 1 − α:
/// with α = 1 there is none.)
///
/// A weight outside 0 to 1 has no meaning, and one that is not a number none either: the nearer end
/// is taken for the first, the gyro alone for the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeConstant<T>(Seconds<T>);

/// Best single value over the recorded motions with optical ground truth of the BROAD benchmark
/// (Laidig et al. 2021): 4.2° mean error of tilt while moving.
///
/// The course's starting value, α = 0.9, is 9 ms at 1 kHz, far too short: a memory like that
/// follows every acceleration of the head as if it were a change of up. Even 31 ms, which is what
/// α = 0.9 comes to at the benchmark's sample rate, scored 21° there.
pub const DEFAULT_TIME_CONSTANT: TimeConstant<f32> = TimeConstant(Seconds(7.6));

impl<T: RealField + Copy> TimeConstant<T> {
    /// τ.
    pub fn new(time: Seconds<T>) -> Self {
        Self(time)
    }

    /// From the notes' α, the weight of the gyro in one sample. Infinite for the gyro alone, α = 1.
    pub fn from_gyro_weight(alpha: T, sample_period: Seconds<T>) -> Self {
        // Not a number is not below one either.
        Self(Seconds(if alpha < T::one() {
            sample_period.0 * alpha.max(T::zero()) / (T::one() - alpha)
        } else {
            T::one() / T::zero()
        }))
    }

    /// τ.
    pub fn time(self) -> Seconds<T> {
        self.0
    }

    /// 1 − α, the share of the accelerometer in one sample: Δt/(τ + Δt), not one minus τ/(τ + Δt),
    /// which in single precision would keep three digits of it.
    ///
    /// From 0 to 1, whatever the time constant and the period are.
    pub fn accelerometer_weight(self, sample_period: Seconds<T>) -> T {
        let weight = sample_period.0 / (self.0.0 + sample_period.0);
        // Not a number is not above zero either.
        if weight > T::zero() {
            weight.min(T::one())
        } else {
            T::zero()
        }
    }

    /// α, the share of the gyro in one sample, from 0 to 1.
    pub fn gyro_weight(self, sample_period: Seconds<T>) -> T {
        T::one() - self.accelerometer_weight(sample_period)
    }
}
