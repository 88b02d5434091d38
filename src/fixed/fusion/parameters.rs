//! What a person chooses, as weights, counts and limits in fixed point.

use super::super::gyro::Nanoseconds;
use super::super::multiply::Multiply;
use super::super::number::Q;
use crate::sensor::Ranges;
use crate::units::{RADIANS_PER_DEGREE, Seconds};

/// How often samples come, and what their counts mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rates {
    /// Between two samples of gyro and accelerometer.
    pub sample: Nanoseconds,
    /// Between two of the magnetometer; without one it plays no part.
    pub field: Nanoseconds,
    /// What the sensor was set to.
    pub ranges: Ranges,
}

impl Rates {
    /// A block of so many samples.
    pub fn block(&self, samples: u32) -> Nanoseconds {
        Nanoseconds(self.sample.0.saturating_mul(samples))
    }

    /// Counts of the gyro per °/s.
    pub fn counts_per_dps(&self) -> f32 {
        self.ranges.gyro.counts_per_dps()
    }

    /// And per rad/s.
    pub fn counts_per_rad_per_s(&self) -> f32 {
        self.counts_per_dps() * const { (1.0 / RADIANS_PER_DEGREE) as f32 }
    }

    /// Counts of the accelerometer per g: 2¹¹ to 2¹⁴.
    pub fn counts_per_g(&self) -> f32 {
        f32::from(self.ranges.accel.counts_per_g())
    }
}

/// As the scalar that parameters are derived in.
pub fn seconds(period: Nanoseconds) -> Seconds<f32> {
    Seconds(period.0 as f32 * 1e-9)
}

/// Whole samples in a time, at least one. In whole nanoseconds: where a time is so many samples and a
/// half, single precision would round it either way.
#[inline(never)]
pub fn samples(time: Seconds<f32>, period: Nanoseconds) -> u32 {
    // A cast saturates, and makes zero of what is not a number.
    let twice = ((time.0 * 1e9) as u64).saturating_mul(2);
    let period = u64::from(period.0.max(1));
    let count = twice.saturating_add(period) / (2 * period);
    u32::try_from(count).unwrap_or(u32::MAX).max(1)
}

/// A weight in a low-pass: at most just below ½, which a time of two samples has.
pub fn weight<M: Multiply>(weight: f32) -> Q<M, 32> {
    Q::nearest(weight)
}

/// The square of a size of so many counts, as [`Vector::squared`](super::super::vector::Vector::squared) of
/// 15 fraction bits has it.
pub fn squared(counts: f32) -> u64 {
    let size = counts * (1 << 15) as f32;
    (size * size) as u64
}
