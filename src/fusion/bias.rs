//! What the gyro reads when nothing turns. At rest that is its mean; on the move, what the errors of
//! tilt and heading add up to says it slowly.

use super::parameters::{Parameters, Rates, samples, scalar, share, size, weight};
use crate::units::{AngularRate, RADIANS_PER_DEGREE, Seconds};
use nalgebra::{RealField, Vector3, convert};

/// How the bias is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Not at all yet, but by the slow integrals: there was no rest since the start.
    Unmeasured,
    /// Measured at rest so many samples ago, and followed slowly since.
    Rest {
        /// Samples since the end of that rest; 0 while it lasts.
        samples: u32,
    },
}

/// The gyro's bias, body frame.
#[derive(Clone, Copy, Debug)]
pub struct Bias<T: RealField> {
    coefficients: Coefficients<T>,
    rad_per_s: Vector3<T>,
    at_rest: Option<Vector3<T>>,
    source: Source,
    /// Samples since the start.
    age: u32,
    /// Fields since the start that told of the heading.
    fields: u32,
}

#[derive(Clone, Copy, Debug)]
struct Coefficients<T> {
    period: T,
    field_period: T,
    /// rad/s.
    largest: T,
    /// Gain in [`TILT_EVERY`] samples, 1/s.
    tilt: T,
    tilt_start: T,
    /// Samples until the gain is the lasting one.
    tilt_start_samples: u32,
    heading: T,
    heading_start: T,
    rest_worth: T,
    /// Samples a mean at rest goes back at most.
    memory: u32,
    /// Fields before the first of which the heading has not settled.
    field_start: u32,
}

/// Samples per look at the tilt's error.
const TILT_EVERY: u32 = 8;
/// A rest of hours follows the temperature: the mean goes back a minute, s.
const MEMORY: f64 = 60.0;
/// The compass is left alone for its first second.
const FIELD_START: f64 = 1.0;

impl<T: RealField + Copy> Coefficients<T> {
    fn new(parameters: &Parameters<T>, rates: Rates<T>) -> Self {
        Self {
            period: size(rates.sample.0),
            field_period: size(rates.field.0),
            largest: size(parameters.largest_bias_dps * convert(RADIANS_PER_DEGREE)),
            tilt: size(parameters.tilt_integral * rates.sample.0 * scalar(TILT_EVERY)),
            tilt_start: size(parameters.tilt_integral_start.0),
            tilt_start_samples: samples(parameters.tilt_integral_start, rates.sample),
            heading: size(parameters.heading_integral * rates.field.0),
            heading_start: size(parameters.heading_integral_start * rates.field.0),
            rest_worth: size(parameters.rest_worth.0),
            memory: samples(Seconds(convert(MEMORY)), rates.sample),
            field_start: samples(Seconds(convert(FIELD_START)), rates.field),
        }
    }
}

impl<T: RealField + Copy> Bias<T> {
    pub(super) fn new(parameters: &Parameters<T>, rates: Rates<T>) -> Self {
        Self {
            coefficients: Coefficients::new(parameters, rates),
            rad_per_s: Vector3::zeros(),
            at_rest: None,
            source: Source::Unmeasured,
            age: 0,
            fields: 0,
        }
    }

    pub(super) fn tune(&mut self, parameters: &Parameters<T>, rates: Rates<T>) {
        self.coefficients = Coefficients::new(parameters, rates);
    }

    /// As it is subtracted.
    pub fn rate(&self) -> AngularRate<T> {
        AngularRate::from_rad_per_s(self.rad_per_s)
    }

    /// How it is known.
    pub fn source(&self) -> Source {
        self.source
    }

    /// As measured in the last rest; none without one.
    pub fn at_rest(&self) -> Option<AngularRate<T>> {
        self.at_rest.map(AngularRate::from_rad_per_s)
    }

    pub(super) fn rad_per_s(&self) -> Vector3<T> {
        self.rad_per_s
    }

    pub(super) fn set(&mut self, at_rest: AngularRate<T>) {
        let rate = at_rest.rad_per_s();
        if rate.iter().all(|component| component.is_finite()) {
            self.rad_per_s = self.bounded(rate);
            self.at_rest = Some(self.rad_per_s);
            self.source = Source::Rest { samples: 0 };
        }
    }

    /// The `number`th sample of a rest (from 1): the mean of the low-passed rate.
    pub(super) fn rests(&mut self, mean_rate: Vector3<T>, number: u32) {
        self.age = self.age.saturating_add(1);
        let number = number.min(self.coefficients.memory);
        let step = (mean_rate - self.rad_per_s) * share::<T>(number);
        self.rad_per_s = self.bounded(self.rad_per_s + step);
        self.at_rest = Some(self.rad_per_s);
        self.source = Source::Rest { samples: 0 };
    }

    /// A sample on the move.
    pub(super) fn moves(&mut self) {
        self.age = self.age.saturating_add(1);
        if let Source::Rest { samples } = &mut self.source {
            *samples = samples.saturating_add(1);
        }
    }

    /// The errors of this sample, times their gains: rad/s in the world. None where there is nothing to
    /// add: the tilt's error is looked at in every eighth sample, for it changes slowly and a turn into
    /// the body's axes is dear; the heading's with every field.
    ///
    /// Until the first rest nothing is known, so the gains begin high and fall as 1/(1 + t): that for tilt
    /// is k_i max(1, t₀/(1 + t)). A rest tells more of the bias than any motion, and more than any
    /// compass near steel: after one the tilt's gain is k_i, and the heading's comes back only as the
    /// temperature may have changed.
    pub(super) fn integrals(&mut self, tilt: [T; 2], heading: Option<T>) -> Option<Vector3<T>> {
        let tilt_is_due = self.age.is_multiple_of(TILT_EVERY);
        if !tilt_is_due && heading.is_none() {
            return None;
        }
        let Coefficients {
            period,
            field_period,
            tilt: mut tilt_gain,
            tilt_start,
            tilt_start_samples,
            heading: heading_gain,
            heading_start,
            rest_worth,
            field_start,
            ..
        } = self.coefficients;
        let seconds = |samples: u32, period: T| scalar::<T>(samples) * period;
        if self.source == Source::Unmeasured && self.age <= tilt_start_samples {
            let high = tilt_start / (T::one() + seconds(self.age, period));
            tilt_gain *= high.max(T::one());
        }
        if !tilt_is_due {
            tilt_gain = T::zero();
        }
        let heading = heading.map_or_else(T::zero, |error| {
            self.fields = self.fields.saturating_add(1);
            if self.fields <= field_start {
                return T::zero();
            }
            let gain = match self.source {
                Source::Unmeasured => heading_gain
                    .max(heading_start / (T::one() + seconds(self.fields, field_period))),
                Source::Rest { samples } => {
                    heading_gain * weight(seconds(samples, period) / rest_worth)
                }
            };
            error * gain
        });
        Some(Vector3::new(
            tilt[0] * tilt_gain,
            heading,
            tilt[1] * tilt_gain,
        ))
    }

    /// Takes an error of the rate (rad/s, body frame) off the bias.
    pub(super) fn shift(&mut self, error: Vector3<T>) {
        self.rad_per_s = self.bounded(self.rad_per_s - error);
    }

    fn bounded(&self, rate: Vector3<T>) -> Vector3<T> {
        let largest = self.coefficients.largest;
        rate.map(|component| component.clamp(-largest, largest))
    }
}
