//! What a person chooses. Every value is a time in seconds or a physical size; no weight per sample,
//! which would mean another filter at another rate.

use crate::units::Seconds;
use nalgebra::{RealField, convert, try_convert};

/// How often samples come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates<T> {
    /// Between two samples of gyro and accelerometer.
    pub sample: Seconds<T>,
    /// Between two of the magnetometer; without one it plays no part.
    pub field: Seconds<T>,
}

/// The parameters of [`Fusion`](super::Fusion).
///
/// The defaults hold for every motion alike. Times, dampings and gains were chosen on the 20 recordings
/// of the BROAD benchmark taken together, never on a single one, and all but one lie on a plateau
/// (`heading_integral_start` has its best at 0.1: half a degree of a cold start with compass). The
/// limits on the bias are the sensor's. `cargo accuracy` prints what they score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters<T> {
    /// τ: an error of tilt is gone in about this time. 3 s.
    pub tilt_time: Seconds<T>,
    /// ζ of the second-order filter. 0.5: it overshoots by a sixth and forgets quickly.
    pub damping: T,
    /// How far ahead of the last sample the orientation is given, at the last rate. 0: off.
    pub lead: Seconds<T>,
    /// The force averaged at the start, weighing every sample alike. 1 s.
    pub start_time: Seconds<T>,
    /// Gain of the integral of the tilt's error into the bias, 1/s². 0.01.
    pub tilt_integral: T,
    /// Until the first rest the gain is `time/(1 + t)` times as large, down to the gain itself. 80 s.
    pub tilt_integral_start: Seconds<T>,
    /// Low-pass of rate and force for the detection of rest. 0.5 s.
    pub rest_filter_time: Seconds<T>,
    /// How long nothing may move before that counts as rest. 1.5 s.
    pub rest_time: Seconds<T>,
    /// Most the rate may differ from its low-pass at rest, °/s. 2.
    pub rest_rate_dps: T,
    /// Most the force may differ from its low-pass at rest, m/s². 0.5.
    pub rest_force: T,
    /// Largest bias believed, °/s per axis: the data sheet's zero-rate offset is ±5 at 25 °C, plus
    /// its change with temperature. 10.
    pub largest_bias_dps: T,
    /// Largest rate that a rest may show and still be one, °/s per axis, unless a bias near it was measured
    /// before. 2, as in VQF: larger ones are measured by the board's one-second window.
    pub rest_bias_dps: T,
    /// Most a bias once measured at rest is believed to have changed by the next rest, °/s; beyond it
    /// the board is taken to turn slowly. 1.
    pub largest_change_dps: T,
    /// An error of heading is gone in about this time. 15 s.
    pub heading_time: Seconds<T>,
    /// Gain of the integral of the heading's error into the bias, 1/s²: what it is without a rest, or
    /// [`Self::rest_worth`] after one. 0.003.
    pub heading_integral: T,
    /// The same at the start, 1/s², falling as 1/(1 + t) and only until the first rest. 0.1.
    pub heading_integral_start: T,
    /// How long a bias measured at rest outdoes any compass. 600 s.
    pub rest_worth: Seconds<T>,
    /// How far the field may lie from the reference, of its size, before it is disturbed. 0.15.
    pub field_tolerance: T,
    /// How quickly the reference follows the field. 20 s.
    pub field_time: Seconds<T>,
    /// How long another field must have been met while turning before it becomes the reference, at
    /// the least and at the most; between them, as long as the reference itself was met. 5 s, 60 s.
    pub new_field_time: [Seconds<T>; 2],
}

impl<T: RealField + Copy> Default for Parameters<T> {
    fn default() -> Self {
        let seconds = |time: f64| Seconds(convert(time));
        Self {
            tilt_time: seconds(3.0),
            damping: convert(0.5),
            lead: seconds(0.0),
            start_time: seconds(1.0),
            tilt_integral: convert(0.01),
            tilt_integral_start: seconds(80.0),
            rest_filter_time: seconds(0.5),
            rest_time: seconds(1.5),
            rest_rate_dps: convert(2.0),
            rest_force: convert(0.5),
            largest_bias_dps: convert(10.0),
            rest_bias_dps: convert(2.0),
            largest_change_dps: convert(1.0),
            heading_time: seconds(15.0),
            heading_integral: convert(0.003),
            heading_integral_start: convert(0.1),
            rest_worth: seconds(600.0),
            field_tolerance: convert(0.15),
            field_time: seconds(20.0),
            new_field_time: [seconds(5.0), seconds(60.0)],
        }
    }
}

/// 1 − e^(−Δt/τ), the share of a new sample in a low-pass of first order; from 0 to 1 for any times.
pub(crate) fn low_pass_weight<T: RealField + Copy>(time: Seconds<T>, period: Seconds<T>) -> T {
    weight(-(-period.0 / time.0).exp_m1())
}

/// Samples per look at what changes slowly: rest, and what the tilt's error says of the bias.
pub(crate) const DECIMATION: u32 = 8;

/// The share of the newest in the low-pass of the tilt's error, 1 − exp(−2ζω₀Δt) with ω₀ = √2/τ.
pub(crate) fn tilt_low_pass_weight<T: RealField + Copy>(
    parameters: &Parameters<T>,
    period: Seconds<T>,
) -> T {
    let twice_damping = parameters.damping * convert(2.0);
    let time = parameters.tilt_time.0 / (twice_damping * convert(core::f64::consts::SQRT_2));
    low_pass_weight(Seconds(time), period)
}

/// The share of the low-passed error that is corrected in a sample, ω₀Δt/2ζ.
pub(crate) fn tilt_correction<T: RealField + Copy>(
    parameters: &Parameters<T>,
    period: Seconds<T>,
) -> T {
    let natural = convert::<f64, T>(core::f64::consts::SQRT_2) / parameters.tilt_time.0;
    weight(natural * period.0 / (parameters.damping * convert(2.0)))
}

/// A weight of no meaning is the nearer end; one that is not a number is none.
pub(crate) fn weight<T: RealField + Copy>(value: T) -> T {
    if value > T::zero() {
        value.min(T::one())
    } else {
        T::zero()
    }
}

/// A size or a gain that has no meaning is none.
pub(crate) fn size<T: RealField + Copy>(value: T) -> T {
    if value > T::zero() && value.is_finite() {
        value
    } else {
        T::zero()
    }
}

/// Whole samples in a time, at least one; what is no time is one sample, what is without end the
/// largest number.
pub(crate) fn samples<T: RealField + Copy>(time: Seconds<T>, period: Seconds<T>) -> u32 {
    let count: f32 = try_convert((time.0 / period.0).round()).unwrap_or(0.0);
    // A cast to an integer saturates, and makes zero of what is not a number.
    (count as u32).max(1)
}

/// A count as a scalar. By way of single precision, which is what the board has, and near enough for a
/// time.
pub(crate) fn scalar<T: RealField + Copy>(count: u32) -> T {
    convert(count as f32)
}

/// 1/n: what the nth of as many has a share of in their mean.
pub(crate) fn share<T: RealField + Copy>(count: u32) -> T {
    T::one() / scalar(count)
}
