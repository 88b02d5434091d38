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
    /// As it was at the last two marks of a rest: its end is the beginning of a motion.
    marks: [Vector3<T>; 2],
    /// Blocks in the mean of this rest.
    count: u32,
    source: Source,
}

#[derive(Clone, Copy, Debug)]
struct Coefficients<T> {
    /// rad/s.
    largest: T,
    /// Blocks that a mean at rest goes back at most.
    memory: u32,
    /// Blocks that a bias known before weighs in it.
    weight: u32,
    /// Blocks between two marks.
    mark: u32,
}

/// A long rest follows the temperature: the mean goes back so far, s.
pub const MEMORY: f64 = 5.0;
/// What was known before a rest counts like so much of it, s.
pub const WEIGHT: f64 = 1.0;
/// A rest ends so long before it is seen to, s: once or twice this is taken back.
pub const MARK: f64 = 0.25;

impl<T: RealField + Copy> Coefficients<T> {
    fn new(parameters: &Parameters<T>, rates: Rates<T>) -> Self {
        let block = Seconds(rates.sample.0 * scalar(DECIMATION));
        let blocks = |time: f64| samples(Seconds(convert(time)), block);
        Self {
            largest: size(parameters.largest_bias_dps * convert(RADIANS_PER_DEGREE)),
            memory: blocks(MEMORY),
            weight: blocks(WEIGHT),
            mark: blocks(MARK),
        }
    }
}

impl<T: RealField + Copy> Bias<T> {
    pub(super) fn new(parameters: &Parameters<T>, rates: Rates<T>) -> Self {
        Self {
            coefficients: Coefficients::new(parameters, rates),
            rad_per_s: Vector3::zeros(),
            at_rest: None,
            marks: [Vector3::zeros(); 2],
            count: 0,
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

    /// False if it is none that can be believed; then nothing changes.
    pub(super) fn guess(&mut self, rate: AngularRate<T>) -> bool {
        let rate = rate.rad_per_s();
        let within = rate
            .iter()
            .all(|part| part.abs() <= self.coefficients.largest);
        if within {
            self.rad_per_s = rate;
        }
        within
    }

    /// The same of one measured at rest.
    pub(super) fn set(&mut self, at_rest: AngularRate<T>) -> bool {
        let within = self.guess(at_rest);
        if within {
            self.at_rest = Some(self.rad_per_s);
            self.marks = [self.rad_per_s; 2];
            self.source = Source::Rest { samples: 0 };
        }
        within
    }

    /// A rest begins: the mean rate of the calm that led to it, rad/s, of so many blocks. What is known
    /// already is a part of the mean.
    pub(super) fn begins_to_rest(&mut self, rate: Vector3<T>, blocks: u32) {
        let known = if self.at_rest.is_some() {
            self.coefficients.weight
        } else {
            0
        };
        let whole = blocks.saturating_add(known);
        let part = scalar::<T>(blocks) / scalar(whole);
        self.count = whole;
        self.approach(rate, part);
        self.marks = [self.rad_per_s; 2];
    }

    /// It goes on: the rate of another block, rad/s.
    pub(super) fn rests(&mut self, rate: Vector3<T>) {
        let Coefficients { memory, mark, .. } = self.coefficients;
        self.count = self.count.saturating_add(1);
        self.approach(rate, share(self.count.min(memory)));
        if self.count.is_multiple_of(mark) {
            self.marks = [self.marks[1], self.rad_per_s];
        }
    }

    fn approach(&mut self, rate: Vector3<T>, part: T) {
        let step = (rate - self.rad_per_s) * part;
        self.rad_per_s = self.bounded(self.rad_per_s + step);
        self.at_rest = Some(self.rad_per_s);
        self.source = Source::Rest { samples: 0 };
    }

    /// A block on the move.
    pub(super) fn moves(&mut self) {
        if let Source::Rest { samples } = &mut self.source {
            if *samples == 0 && self.at_rest == Some(self.rad_per_s) {
                // The last blocks of the rest were the first of this motion.
                self.rad_per_s = self.marks[0];
                self.at_rest = Some(self.marks[0]);
            }
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
