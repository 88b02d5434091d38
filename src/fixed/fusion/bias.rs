//! What the gyro reads when nothing turns. At rest that is its mean; on the move,
//! [`Integral`](super::integral::Integral) moves it slowly.

use super::super::division::per;
use super::super::multiply::Multiply;
use super::super::number::Q;
use super::super::vector::{Vector, WideVector};
use super::parameters::{Rates, samples};
use crate::fusion::bias::{MARK, MEMORY, WEIGHT};
use crate::fusion::parameters::{DECIMATION, size};
use crate::fusion::{Parameters, Source};
use crate::units::{AngularRate, Seconds};
use core::num::NonZeroU32;

/// The gyro's bias in counts, body frame.
#[derive(Clone, Copy, Debug)]
pub struct Bias<M> {
    coefficients: Coefficients<M>,
    /// As it is subtracted, in the upper half, and what lies below.
    exact: WideVector<M, 47>,
    at_rest: Option<WideVector<M, 47>>,
    /// As it was at the last two marks of a rest: its end is the beginning of a motion.
    marks: [WideVector<M, 47>; 2],
    /// Blocks in the mean of this rest.
    count: u32,
    source: Source,
}

#[derive(Clone, Copy, Debug)]
struct Coefficients<M> {
    counts_per_dps: f32,
    /// Counts.
    largest: Q<M, 15>,
    /// Blocks that a mean at rest goes back at most.
    memory: u32,
    /// Blocks that a bias known before weighs in it.
    weight: u32,
    /// Blocks between two marks.
    mark: NonZeroU32,
}

/// Half the range: no sensor comes near, and whatever is corrected by it fits 32 bits.
const LIMIT: i32 = 1 << 29;

impl<M: Multiply> Coefficients<M> {
    fn new(parameters: &Parameters<f32>, rates: &Rates) -> Self {
        let block = rates.block(DECIMATION);
        let blocks = |time: f64| samples(Seconds(time as f32), block);
        let counts_per_dps = rates.counts_per_dps();
        let largest = Q::nearest(size(parameters.largest_bias_dps) * counts_per_dps);
        Self {
            counts_per_dps,
            largest: largest.limited(Q::from_bits(LIMIT)),
            memory: blocks(MEMORY),
            weight: blocks(WEIGHT),
            mark: NonZeroU32::new(blocks(MARK)).unwrap_or(NonZeroU32::MIN),
        }
    }
}

impl<M: Multiply> Bias<M> {
    pub(super) fn new(parameters: &Parameters<f32>, rates: &Rates) -> Self {
        Self {
            coefficients: Coefficients::new(parameters, rates),
            exact: WideVector::from_upper(Vector::<M, 15>::ZERO),
            at_rest: None,
            marks: [WideVector::ZERO; 2],
            count: 0,
            source: Source::Unmeasured,
        }
    }

    pub(super) fn tune(&mut self, parameters: &Parameters<f32>, rates: &Rates) {
        self.coefficients = Coefficients::new(parameters, rates);
    }

    /// As it is subtracted.
    pub fn rate(&self) -> AngularRate<f32> {
        self.physical(self.counts())
    }

    /// How it is known.
    pub fn source(&self) -> Source {
        self.source
    }

    /// As measured in the last rest; none without one.
    pub fn at_rest(&self) -> Option<AngularRate<f32>> {
        self.known().map(|known| self.physical(known))
    }

    /// Counts as a rate.
    pub(super) fn physical(&self, counts: Vector<M, 15>) -> AngularRate<f32> {
        let dps = counts
            .parts()
            .map(|part| part.to_f32() / self.coefficients.counts_per_dps);
        AngularRate::from_dps(dps.into())
    }

    /// Counts, as they are subtracted.
    #[inline(always)]
    pub(super) fn counts(&self) -> Vector<M, 15> {
        self.exact.upper()
    }

    /// Counts, as measured in the last rest.
    #[inline(always)]
    pub(super) fn known(&self) -> Option<Vector<M, 15>> {
        self.at_rest.map(WideVector::upper)
    }

    /// False if it is none that can be believed; then nothing changes.
    pub(super) fn guess(&mut self, rate: AngularRate<f32>) -> bool {
        let dps: [f32; 3] = rate.dps().into();
        let counts = dps.map(|dps| dps * self.coefficients.counts_per_dps);
        // Written so that what is not a number is not within.
        let largest = self.coefficients.largest.to_f32();
        let within = counts.iter().all(|count| count.abs() <= largest);
        if within {
            let [x, y, z] = counts.map(Q::<M, 15>::nearest);
            self.take(WideVector::from_upper(Vector::new(x, y, z)));
        }
        within
    }

    /// The same of one measured at rest.
    pub(super) fn set(&mut self, at_rest: AngularRate<f32>) -> bool {
        let within = self.guess(at_rest);
        if within {
            self.at_rest = Some(self.exact);
            self.marks = [self.exact; 2];
            self.source = Source::Rest { samples: 0 };
        }
        within
    }

    /// A rest begins: the mean rate of the calm that led to it, of so many blocks. What is known already is a
    /// part of the mean.
    #[cold]
    #[inline(never)]
    pub(super) fn begins_to_rest(&mut self, rate: Vector<M, 15>, blocks: NonZeroU32) {
        let known = if self.at_rest.is_some() {
            self.coefficients.weight
        } else {
            0
        };
        let whole = blocks.saturating_add(known);
        self.count = whole.get();
        let mean = if known == 0 {
            WideVector::from_upper(rate)
        } else {
            // Half the part as Q32: a whole one may be more than that holds.
            let share = u64::from(per::<M, 31>(whole).bits().unsigned_abs());
            let half_part = share.saturating_mul(u64::from(blocks.get()));
            let half_part = Q::<M, 32>::from_bits(half_part.min(i32::MAX as u64) as i32);
            let step = rate - self.exact.upper();
            self.exact.plus(half_part, step).plus(half_part, step)
        };
        self.measured(mean);
        self.marks = [self.exact; 2];
    }

    /// It goes on: the rate of another block.
    #[inline(always)]
    pub(super) fn rests(&mut self, rate: Vector<M, 15>) {
        let Coefficients { memory, mark, .. } = self.coefficients;
        self.count = self.count.saturating_add(1);
        let share = per(NonZeroU32::new(self.count.min(memory)).unwrap_or(NonZeroU32::MIN));
        self.measured(self.exact.towards(rate, share));
        if self.count % mark == 0 {
            self.marks = [self.marks[1], self.exact];
        }
    }

    #[inline(always)]
    fn measured(&mut self, mean: WideVector<M, 47>) {
        self.take(mean);
        self.at_rest = Some(self.exact);
        self.source = Source::Rest { samples: 0 };
    }

    /// A block on the move.
    #[inline(always)]
    pub(super) fn moves(&mut self) {
        if let Source::Rest { samples } = &mut self.source {
            let first = *samples == 0;
            *samples = samples.saturating_add(DECIMATION);
            if first {
                self.begins_to_move();
            }
        }
    }

    #[cold]
    #[inline(never)]
    fn begins_to_move(&mut self) {
        if self.at_rest == Some(self.exact) {
            // The last blocks of the rest were the first of this motion.
            self.take(self.marks[0]);
            self.at_rest = Some(self.exact);
        }
    }

    /// Takes an error of the rate (counts, body frame) off the bias: so much along an axis.
    #[inline(always)]
    pub(super) fn shift<const A: usize>(&mut self, errors: [(Q<M, 20>, Vector<M, 27>); A]) {
        let mut shifted = self.exact;
        for (error, axis) in errors {
            shifted = shifted.plus(-error, axis);
        }
        self.take(shifted);
    }

    #[inline(always)]
    fn take(&mut self, rate: WideVector<M, 47>) {
        self.exact = rate;
        if !self.counts().is_within(self.coefficients.largest) {
            self.limit();
        }
    }

    #[cold]
    #[inline(never)]
    fn limit(&mut self) {
        let largest = self.coefficients.largest;
        let [x, y, z] = self.counts().parts().map(|part| part.limited(largest));
        self.exact = WideVector::from_upper(Vector::new(x, y, z));
    }
}
