//! What an estimator is told beside the gyro's counts, as three numbers of 15 fraction bits.

use super::multiply::Multiply;
use super::vector::Vector;
use crate::sensor::AccelRange;
use crate::units::{METRES_PER_S2_PER_G, MagneticField, SpecificForce};

/// Half of what 32 bits hold: a vector of that size has room to turn.
const LIMIT: i32 = 1 << 30;

fn within_limit(parts: [i32; 3]) -> [i32; 3] {
    parts.map(|part| part.clamp(-LIMIT, LIMIT - 1))
}

/// What an accelerometer measures, in its counts, body frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Force([i32; 3]);

impl Force {
    /// Free fall: it says nothing of which way is up.
    pub const ZERO: Self = Self([0; 3]);

    /// As the sensor reports it.
    #[inline(always)]
    pub fn from_counts(counts: [i16; 3]) -> Self {
        // Not by way of `map`, which is a loop in an image built for size.
        let [x, y, z] = counts;
        Self([i32::from(x) << 15, i32::from(y) << 15, i32::from(z) << 15])
    }

    /// From physical units, at the range the accelerometer was set to. Zero for what is not a number.
    pub fn new(force: SpecificForce<f32>, range: AccelRange) -> Self {
        const PARTS_PER_COUNT: f32 = 32768.0;
        let per_g = f32::from(range.counts_per_g()) * PARTS_PER_COUNT;
        let per_m_per_s2 = per_g * const { 1.0 / METRES_PER_S2_PER_G as f32 };
        let m_per_s2: [f32; 3] = force.m_per_s2().into();
        // A cast saturates.
        Self::from_parts_of_counts(m_per_s2.map(|part| (part * per_m_per_s2) as i32))
    }

    /// In 2⁻¹⁵ counts; what is beyond the range of whole counts (±2¹⁵) is the end of it.
    #[inline(always)]
    pub fn from_parts_of_counts(parts: [i32; 3]) -> Self {
        Self(within_limit(parts))
    }

    /// In 2⁻¹⁵ counts.
    pub fn parts_of_counts(self) -> [i32; 3] {
        self.0
    }

    #[inline(always)]
    pub(super) fn vector<M: Multiply>(self) -> Vector<M, 15> {
        Vector::from_bits(self.0)
    }
}

/// What a magnetometer measures, µT, body frame, corrected for iron.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field([i32; 3]);

impl Field {
    /// From physical units. Zero for what is not a number.
    pub fn new(field: MagneticField<f32>) -> Self {
        let microtesla: [f32; 3] = field.microtesla().into();
        // A cast saturates.
        Self::from_parts_of_microtesla(microtesla.map(|part| (part * (1 << 15) as f32) as i32))
    }

    /// In 2⁻¹⁵ µT; what is beyond ±2¹⁵ µT, seven times the sensor's range, is the end of that.
    #[inline(always)]
    pub fn from_parts_of_microtesla(parts: [i32; 3]) -> Self {
        Self(within_limit(parts))
    }

    /// In 2⁻¹⁵ µT.
    pub fn parts_of_microtesla(self) -> [i32; 3] {
        self.0
    }

    #[inline(always)]
    pub(super) fn vector<M: Multiply>(self) -> Vector<M, 15> {
        Vector::from_bits(self.0)
    }
}
