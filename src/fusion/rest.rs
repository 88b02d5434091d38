//! Nothing moves if rate and force have stayed close to their own low-pass for a while. They are
//! looked at as means of [`DECIMATION`] samples.

use super::parameters::{DECIMATION, Parameters, low_pass_weight, samples, scalar, share, size};
use crate::units::{AngularRate, RADIANS_PER_DEGREE, Seconds};
use nalgebra::{RealField, Vector3, convert};

/// What the sensor does, and since how many samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// At rest for so long.
    Still {
        /// Samples since rest was noticed, counted in eights.
        samples: u32,
    },
    /// Moving, or not yet still for long enough.
    Moving {
        /// Samples since the end of the last rest, counted in eights; since the start if there was none.
        samples: u32,
    },
}

/// Watches rate and force.
#[derive(Clone, Copy, Debug)]
pub struct Rest<T: RealField> {
    coefficients: Coefficients<T>,
    /// Sums of the block that is under way.
    block: (Vector3<T>, Vector3<T>),
    /// Low-passed rate, rad/s, and force, m/s²; none before the first block.
    mean: Option<(Vector3<T>, Vector3<T>)>,
    /// Blocks in a row close to the mean.
    calm: u32,
    /// The low-passed force when they began, m/s².
    anchor: Vector3<T>,
    /// Sum of the rates of those blocks until the rest begins, without the first third, and how many:
    /// what came before has died away by then.
    settled: (Vector3<T>, u32),
    /// Rate and force of the last block, rad/s and m/s².
    rate: Vector3<T>,
    force: Vector3<T>,
    /// Whether its rate is close to the mean, and that is one of a rest.
    close: bool,
    /// Blocks of calm that make a rest.
    enough: u32,
    /// Whether the last block belongs to a rest.
    still: bool,
    motion: Motion,
}

#[derive(Clone, Copy, Debug)]
struct Coefficients<T> {
    /// Of a block.
    low_pass: T,
    /// Squared, (rad/s)².
    rate: T,
    /// Squared, (m/s²)².
    force: T,
    /// rad/s.
    plausible_bias: T,
    /// rad/s.
    largest_change: T,
    /// Blocks.
    calm: u32,
    /// Calm for so long outdoes a bias known before; blocks.
    long: u32,
}

/// Calm for so many times as long as a rest takes outdoes a bias known before.
pub const LONG: u32 = 4;
/// Most the low-passed force may wander while nothing moves, m/s²: a turn of 1°.
pub const WANDER: f64 = 0.17;

impl<T: RealField + Copy> Coefficients<T> {
    fn new(parameters: &Parameters<T>, period: Seconds<T>) -> Self {
        let radians: T = convert(RADIANS_PER_DEGREE);
        let rate = size(parameters.rest_rate_dps * radians);
        let block = Seconds(period.0 * scalar(DECIMATION));
        let calm = samples(parameters.rest_time, block);
        Self {
            low_pass: low_pass_weight(parameters.rest_filter_time, block),
            rate: rate * rate,
            force: size(parameters.rest_force) * size(parameters.rest_force),
            plausible_bias: size(parameters.rest_bias_dps * radians),
            largest_change: size(parameters.largest_change_dps * radians),
            calm,
            long: calm.saturating_mul(LONG),
        }
    }
}

impl<T: RealField + Copy> Rest<T> {
    pub fn new(parameters: &Parameters<T>, period: Seconds<T>) -> Self {
        Self {
            coefficients: Coefficients::new(parameters, period),
            block: (Vector3::zeros(), Vector3::zeros()),
            mean: None,
            calm: 0,
            anchor: Vector3::zeros(),
            settled: (Vector3::zeros(), 0),
            rate: Vector3::zeros(),
            force: Vector3::zeros(),
            close: false,
            enough: u32::MAX,
            still: false,
            motion: Motion::Moving { samples: 0 },
        }
    }

    pub fn tune(&mut self, parameters: &Parameters<T>, period: Seconds<T>) {
        self.coefficients = Coefficients::new(parameters, period);
    }

    /// One sample, rad/s with its bias and m/s², body frame.
    pub fn add(&mut self, rate: Vector3<T>, force: Vector3<T>) {
        self.block = (self.block.0 + rate, self.block.1 + force);
    }

    /// A block of [`DECIMATION`] samples has ended: its rate. `known` is the bias as measured in the last
    /// rest.
    ///
    /// A steady slow turn about the vertical looks like a bias to a gyro and an accelerometer; about
    /// any other axis the force turns with it. What bounds it is how large a bias usually is, and, once
    /// one was measured at rest, how far it can have drifted since. A rate that is plausible
    /// but far from the known bias must stay for a few seconds.
    pub fn look_at_rate(&mut self, known: Option<AngularRate<T>>) {
        let Coefficients {
            low_pass,
            rate: limit,
            plausible_bias,
            largest_change,
            calm,
            long,
            ..
        } = self.coefficients;
        let share = share::<T>(DECIMATION);
        let (rate, force) = (self.block.0 * share, self.block.1 * share);
        self.block = (Vector3::zeros(), Vector3::zeros());
        (self.rate, self.force) = (rate, force);
        let (mean, mean_force) = self.mean.unwrap_or((rate, force));
        let mean = mean + (rate - mean) * low_pass;
        self.mean = Some((mean, mean_force));
        let near = |known: AngularRate<T>| (mean - known.rad_per_s()).amax() <= largest_change;
        let is_known = known.is_some_and(near);
        self.enough = if known.is_none() || is_known {
            calm
        } else {
            long
        };
        self.close =
            (rate - mean).norm_squared() < limit && (is_known || mean.amax() <= plausible_bias);
    }

    /// Its force, with which it is known whether the block was still.
    pub fn look_at_force(&mut self) {
        let Coefficients {
            low_pass,
            force: limit,
            ..
        } = self.coefficients;
        let (mean_rate, mean) = self.mean.unwrap_or((self.rate, self.force));
        let mean = mean + (self.force - mean) * low_pass;
        self.mean = Some((mean_rate, mean));
        if self.calm == 0 {
            self.anchor = mean;
        }
        let close = self.close
            && (self.force - mean).norm_squared() < limit
            && (mean - self.anchor).norm_squared() < convert(WANDER * WANDER);
        if close {
            self.calm = self.calm.saturating_add(1);
        } else {
            self.calm = 0;
        }
        self.still = self.calm >= self.enough;
    }

    /// Whether there was a block to look at since the start.
    pub fn has_looked(&self) -> bool {
        self.mean.is_some()
    }

    /// What to make of it.
    pub fn judge(&mut self) -> Motion {
        let more = |samples: u32| samples.saturating_add(DECIMATION);
        self.motion = match (self.still, self.motion) {
            (true, Motion::Still { samples }) => Motion::Still {
                samples: more(samples),
            },
            (true, Motion::Moving { .. }) => Motion::Still {
                samples: DECIMATION,
            },
            (false, Motion::Moving { samples }) => Motion::Moving {
                samples: more(samples),
            },
            (false, Motion::Still { .. }) => Motion::Moving {
                samples: DECIMATION,
            },
        };
        self.motion
    }

    /// Keeps the rate of a block that may be the beginning of a rest.
    pub fn settle(&mut self) {
        let third = self.coefficients.calm / 3;
        match (self.calm.saturating_sub(third), self.motion) {
            (0, _) => {}
            (1, _) => self.settled = (self.rate, 1),
            (_, Motion::Still { samples }) if samples > DECIMATION => {}
            _ => self.settled = (self.settled.0 + self.rate, self.settled.1.saturating_add(1)),
        }
    }

    /// Whether the last block is the first of a rest.
    pub fn begins(&self) -> bool {
        matches!(self.motion, Motion::Still { samples } if samples <= DECIMATION)
    }

    /// The low-passed rate, rad/s, body frame; zero before the first sample.
    pub fn mean_rate(&self) -> Vector3<T> {
        self.mean.map_or_else(Vector3::zeros, |(rate, _)| rate)
    }

    /// Mean rate of the calm that led to a rest, rad/s, and of how many blocks.
    pub fn calm_rate(&self) -> (Vector3<T>, u32) {
        let (sum, count) = self.settled;
        (sum * share::<T>(count.max(1)), count.max(1))
    }

    /// Rate of the last block, rad/s.
    pub fn block_rate(&self) -> Vector3<T> {
        self.rate
    }

    pub fn motion(&self) -> Motion {
        self.motion
    }

    /// Forgets what it saw, but not since when the board moves. The next block ends a rest.
    pub fn restart(&mut self) {
        self.block = (Vector3::zeros(), Vector3::zeros());
        self.mean = None;
        self.calm = 0;
    }
}
