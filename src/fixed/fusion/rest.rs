//! Nothing moves if rate and force have stayed close to their own low-pass for a while. They are
//! looked at as means of [`DECIMATION`] samples.

use super::super::division::per;
use super::super::multiply::Multiply;
use super::super::number::{Q, Wide};
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
    /// Sums of rate and force of the block that is under way.
    block: [Vector<M, 12>; 2],
    /// Low-passed rate and force; none before the first block.
    mean: Option<[WideVector<M, 47>; 2]>,
    /// Blocks in a row close to the mean.
    calm: u32,
    /// The low-passed force when they began.
    anchor: Vector<M, 15>,
    /// Sum of the rates of those blocks until the rest begins, without the first third, and how many:
    /// what came before has died away by then.
    settled: ([Wide<M, 15>; 3], u32),
    /// Rate of the last block.
    rate: Vector<M, 15>,
    /// Whether it belongs to a rest.
    still: bool,
    motion: Motion,
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
            block: [Vector::ZERO; 2],
            mean: None,
            calm: 0,
            anchor: Vector::ZERO,
            settled: ([Wide::from_bits(0); 3], 0),
            rate: Vector::ZERO,
            still: false,
            motion: Motion::Moving { samples: 0 },
        }
    }

    pub fn tune(&mut self, parameters: &Parameters<f32>, rates: &Rates) {
        self.coefficients = Coefficients::new(parameters, rates);
    }

    /// One sample, counts of the gyro with their bias and of the accelerometer, body frame.
    #[inline(always)]
    pub fn add(&mut self, gyro: [i16; 3], force: Vector<M, 15>) {
        let [rate_sum, force_sum] = self.block;
        self.block = [
            rate_sum + Vector::from_counts(gyro),
            force_sum + force.coarser(),
        ];
    }

    /// A block of [`DECIMATION`] samples has ended. `known` is the bias as measured in the last rest.
    #[inline(always)]
    pub fn look(&mut self, known: Option<Vector<M, 15>>) {
        const { assert!(DECIMATION == 8) }
        // The sum of eight, read with three more fraction bits, is their mean.
        let [rate, force] = self.block.map(Vector::read_as);
        self.block = [Vector::ZERO; 2];
        self.still = self.is_still(rate, force, known);
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

    /// As in the reference, which says why.
    #[inline(always)]
    fn is_still(
        &mut self,
        rate: Vector<M, 15>,
        force: Vector<M, 15>,
        known: Option<Vector<M, 15>>,
    ) -> bool {
        let Coefficients {
            low_pass,
            rate: rate_limit,
            force: force_limit,
            wander,
            plausible_bias,
            largest_change,
            calm,
            third,
            long,
        } = self.coefficients;
        let [mean_rate, mean_force] = self
            .mean
            .unwrap_or_else(|| [rate, force].map(WideVector::from_upper));
        let mean = [
            mean_rate.towards(rate, low_pass),
            mean_force.towards(force, low_pass),
        ];
        self.mean = Some(mean);
        let [mean_rate, mean_force] = mean.map(WideVector::upper);
        self.rate = rate;
        let is_known = known.is_some_and(|known| (mean_rate - known).is_within(largest_change));
        if self.calm == 0 {
            self.anchor = mean_force;
        }
        let close = (rate - mean_rate).squared() < rate_limit
            && (force - mean_force).squared() < force_limit
            && (mean_force - self.anchor).squared() < wander
            && (is_known || mean_rate.is_within(plausible_bias));
        if close {
            self.calm = self.calm.saturating_add(1);
            if self.calm > third && matches!(self.motion, Motion::Moving { .. }) {
                let ([x, y, z], count) = self.settled;
                let sums = [x.with(rate.x), y.with(rate.y), z.with(rate.z)];
                self.settled = (sums, count.saturating_add(1));
            }
        } else {
            self.forget();
        }
        let enough = if known.is_none() || is_known {
            calm
        } else {
            long
        };
        self.calm >= enough
    }

    /// The low-passed rate, body frame; zero before the first sample.
    pub fn mean_rate(&self) -> Vector<M, 15> {
        self.mean.map_or(Vector::ZERO, |[rate, _]| rate.upper())
    }

    /// Mean rate of the calm that led to a rest, and of how many blocks.
    pub fn calm_rate(&self) -> (Vector<M, 15>, NonZeroU32) {
        let (sums, count) = self.settled;
        let count = NonZeroU32::new(count).unwrap_or(NonZeroU32::MIN);
        let [x, y, z] = sums.map(|sum| mean(sum, count));
        (Vector::new(x, y, z), count)
    }

    /// Rate of the last block.
    #[inline(always)]
    pub fn block_rate(&self) -> Vector<M, 15> {
        self.rate
    }

    #[inline(always)]
    fn forget(&mut self) {
        self.calm = 0;
        self.settled = ([Wide::from_bits(0); 3], 0);
    }

    #[inline(always)]
    pub fn motion(&self) -> Motion {
        self.motion
    }

    /// Forgets what it saw, but not since when the board moves. A rest is over.
    pub fn restart(&mut self) {
        self.block = [Vector::ZERO; 2];
        self.mean = None;
        self.still = false;
        self.forget();
    }
}

/// The sum of so many over their number.
fn mean<M: Multiply>(sum: Wide<M, 15>, count: NonZeroU32) -> Q<M, 15> {
    // The sum's first 31 bits are enough.
    let size = sum.bits().unsigned_abs();
    let shift = 33_u32.saturating_sub(size.leading_zeros());
    let first = Q::<M, 15>::from_bits((sum.bits() >> shift) as i32);
    let share: Q<M, 31> = per(count);
    Q::from_bits((((first.wide(share) >> 16) << shift) >> 15) as i32)
}
