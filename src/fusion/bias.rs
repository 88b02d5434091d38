//! What the gyro reads when nothing turns. At rest that is its mean; on the move,
//! [`Integral`](super::integral::Integral) moves it slowly.

use super::parameters::{DECIMATION, Parameters, Rates, samples, scalar, share, size};
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
}

#[derive(Clone, Copy, Debug)]
struct Coefficients<T> {
    /// rad/s.
    largest: T,
    /// Blocks that a mean at rest goes back at most.
    memory: u32,
}

/// A rest of hours follows the temperature: the mean goes back a minute, s.
const MEMORY: f64 = 60.0;

impl<T: RealField + Copy> Coefficients<T> {
    fn new(parameters: &Parameters<T>, rates: Rates<T>) -> Self {
        Self {
            largest: size(parameters.largest_bias_dps * convert(RADIANS_PER_DEGREE)),
            memory: samples(
                Seconds(convert(MEMORY)),
                Seconds(rates.sample.0 * scalar(DECIMATION)),
            ),
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

    pub(super) fn guess(&mut self, rate: AngularRate<T>) {
        let rate = rate.rad_per_s();
        if rate.iter().all(|component| component.is_finite()) {
            self.rad_per_s = self.bounded(rate);
        }
    }

    pub(super) fn set(&mut self, at_rest: AngularRate<T>) {
        self.guess(at_rest);
        self.at_rest = Some(self.rad_per_s);
        self.source = Source::Rest { samples: 0 };
    }

    /// The `number`th block of a rest (from 1): the mean of the low-passed rate.
    pub(super) fn rests(&mut self, mean_rate: Vector3<T>, number: u32) {
        let number = number.min(self.coefficients.memory);
        let step = (mean_rate - self.rad_per_s) * share::<T>(number);
        self.rad_per_s = self.bounded(self.rad_per_s + step);
        self.at_rest = Some(self.rad_per_s);
        self.source = Source::Rest { samples: 0 };
    }

    /// A block on the move.
    pub(super) fn moves(&mut self) {
        if let Source::Rest { samples } = &mut self.source {
            *samples = samples.saturating_add(DECIMATION);
        }
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
