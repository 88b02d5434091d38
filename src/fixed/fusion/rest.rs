//! Nothing moves if rate and force have stayed close to their own low-pass for a while. They are
//! looked at as means of [`DECIMATION`] samples.

use super::super::division::per;
use super::super::multiply::Multiply;
use super::super::number::Q;
use super::super::vector::{Vector, WideVector};
use super::parameters::{Rates, samples, seconds, squared, weight};
use crate::fusion::parameters::{DECIMATION, low_pass_weight, size};
use crate::fusion::rest::{LONG, WANDER};
use crate::fusion::{Motion, Parameters};
use crate::units::METRES_PER_S2_PER_G;
use core::num::NonZeroU32;

/// Watches rate and force, in counts.
#[derive(Clone, Copy, Debug)]
pub struct Rest<M> {
    coefficients: Coefficients<M>,
    block: Block<M>,
    /// Low-passed rate and force.
    mean_rate: WideVector<M, 47>,
    mean_force: WideVector<M, 47>,
    /// Whether there was no block yet.
    fresh: bool,
    /// Rate and force of the last block.
    rate: Vector<M, 15>,
    force: Vector<M, 15>,
    /// Whether its rate is close to the mean, and that is one of a rest.
    close: bool,
    /// Blocks of calm that make a rest.
    enough: u32,
    /// Blocks in a row close to the mean.
    calm: u32,
    /// The low-passed force when they began.
    anchor: Vector<M, 15>,
    /// Mean of the rates of those blocks until the rest begins, without the first third, and of how many:
    /// what came before has died away by then.
    settled: WideVector<M, 47>,
    settled_count: NonZeroU32,
    /// Whether the last block belongs to a rest.
    still: bool,
    motion: Motion,
}

/// Sums of the block that is under way.
#[derive(Clone, Copy, Debug)]
struct Block<M> {
    rate: Vector<M, 12>,
    force: Vector<M, 12>,
}

impl<M: Multiply> Block<M> {
    const EMPTY: Self = Self {
        rate: Vector::ZERO,
        force: Vector::ZERO,
    };
}

#[derive(Clone, Copy, Debug)]
struct Coefficients<M> {
    /// Of a block.
    low_pass: Q<M, 32>,
    /// Counts squared, as Q30.
    rate: u64,
    force: u64,
    wander: u64,
    /// Counts.
    plausible_bias: Q<M, 15>,
    largest_change: Q<M, 15>,
    /// Blocks.
    calm: u32,
    third: u32,
    /// Calm for so long outdoes a bias known before; blocks.
    long: u32,
}

impl<M: Multiply> Coefficients<M> {
    fn new(parameters: &Parameters<f32>, rates: &Rates) -> Self {
        let block = rates.block(DECIMATION);
        let calm = samples(parameters.rest_time, block);
        let gyro = |dps: f32| size(dps) * rates.counts_per_dps();
        let per_m_per_s2 = rates.counts_per_g() / METRES_PER_S2_PER_G as f32;
        Self {
            low_pass: weight(low_pass_weight(parameters.rest_filter_time, seconds(block))),
            rate: squared(gyro(parameters.rest_rate_dps)),
            force: squared(size(parameters.rest_force) * per_m_per_s2),
            wander: squared(WANDER as f32 * per_m_per_s2),
            plausible_bias: Q::nearest(gyro(parameters.rest_bias_dps)),
            largest_change: Q::nearest(gyro(parameters.largest_change_dps)),
            calm,
            third: calm / 3,
            long: calm.saturating_mul(LONG),
        }
    }
}

impl<M: Multiply> Rest<M> {
    pub fn new(parameters: &Parameters<f32>, rates: &Rates) -> Self {
        Self {
            coefficients: Coefficients::new(parameters, rates),
            block: Block::EMPTY,
            mean_rate: WideVector::ZERO,
            mean_force: WideVector::ZERO,
            fresh: true,
            rate: Vector::ZERO,
            force: Vector::ZERO,
            close: false,
            enough: u32::MAX,
            calm: 0,
            anchor: Vector::ZERO,
            settled: WideVector::ZERO,
            settled_count: NonZeroU32::MIN,
            still: false,
            motion: Motion::Moving { samples: 0 },
        }
    }

    pub fn tune(&mut self, parameters: &Parameters<f32>, rates: &Rates) {
        self.coefficients = Coefficients::new(parameters, rates);
    }

    /// One sample: counts of the gyro with their bias.
    #[inline(always)]
    pub fn add_rate(&mut self, gyro: [i16; 3]) {
        self.block.rate = self.block.rate + Vector::from_counts(gyro);
    }

    /// And those of the accelerometer, body frame.
    #[inline(always)]
    pub fn add_force(&mut self, force: Vector<M, 15>) {
        self.block.force = self.block.force + force.coarser();
    }

    /// A block of [`DECIMATION`] samples has ended: its rate. `known` is the bias as measured in the last rest.
    #[inline(always)]
    pub fn look_at_rate(&mut self, known: Option<Vector<M, 15>>) {
        const { assert!(DECIMATION == 8) }
        // The sum of eight, read with three more fraction bits, is their mean.
        let (rate, force) = (self.block.rate.read_as(), self.block.force.read_as());
        self.block = Block::EMPTY;
        (self.rate, self.force) = (rate, force);
        if self.fresh {
            self.fresh = false;
            self.mean_rate = WideVector::from_upper(rate);
            self.mean_force = WideVector::from_upper(force);
        } else {
            self.mean_rate = self.mean_rate.towards(rate, self.coefficients.low_pass);
        }
        let mean: Vector<M, 15> = self.mean_rate.upper();
        let is_near =
            |known: Vector<M, 15>| (mean - known).is_within(self.coefficients.largest_change);
        let is_known = known.is_some_and(is_near);
        self.enough = if known.is_none() || is_known {
            self.coefficients.calm
        } else {
            self.coefficients.long
        };
        self.close = (rate - mean).squared() < self.coefficients.rate
            && (is_known || mean.is_within(self.coefficients.plausible_bias));
    }

    /// Its force, with which it is known whether the block was still.
    #[inline(always)]
    pub fn look_at_force(&mut self) {
        let force = self.force;
        self.mean_force = self.mean_force.towards(force, self.coefficients.low_pass);
        let mean: Vector<M, 15> = self.mean_force.upper();
        if self.calm == 0 {
            self.anchor = mean;
        }
        let close = self.close
            && (force - mean).squared() < self.coefficients.force
            && (mean - self.anchor).squared() < self.coefficients.wander;
        if close {
            self.calm = self.calm.saturating_add(1);
        } else {
            self.calm = 0;
        }
        self.still = self.calm >= self.enough;
    }

    /// Whether there was a block to look at since the start.
    #[inline(always)]
    pub fn has_looked(&self) -> bool {
        !self.fresh
    }

    /// What to make of it.
    #[inline(always)]
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
    #[inline(always)]
    pub fn settle(&mut self) {
        let third = self.coefficients.third;
        match (self.calm.saturating_sub(third), self.motion) {
            (0, _) => {}
            (1, _) => {
                self.settled = WideVector::from_upper(self.rate);
                self.settled_count = NonZeroU32::MIN;
            }
            (_, Motion::Still { samples }) if samples > DECIMATION => {}
            _ => {
                self.settled_count = self.settled_count.saturating_add(1);
                self.settled = self.settled.towards(self.rate, per(self.settled_count));
            }
        }
    }

    /// Whether the last block is the first of a rest.
    #[inline(always)]
    pub fn begins(&self) -> bool {
        matches!(self.motion, Motion::Still { samples } if samples <= DECIMATION)
    }

    /// The low-passed rate, body frame; zero before the first sample.
    pub fn mean_rate(&self) -> Vector<M, 15> {
        self.mean_rate.upper()
    }

    /// Mean rate of the calm that led to a rest, and of how many blocks.
    pub fn calm_rate(&self) -> (Vector<M, 15>, NonZeroU32) {
        (self.settled.upper(), self.settled_count)
    }

    /// Rate of the last block.
    #[inline(always)]
    pub fn block_rate(&self) -> Vector<M, 15> {
        self.rate
    }

    #[inline(always)]
    pub fn motion(&self) -> Motion {
        self.motion
    }

    /// Forgets what it saw, but not since when the board moves. The next block ends a rest.
    pub fn restart(&mut self) {
        self.block = Block::EMPTY;
        self.mean_rate = WideVector::ZERO;
        self.fresh = true;
        self.calm = 0;
    }
}
