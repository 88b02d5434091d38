//! What an estimator is told beside the gyro's counts, as three numbers of 15 fraction bits.

use super::vector::Vector;

/// Half of what 32 bits hold: a vector of that size has room to turn.
const LIMIT: i32 = 1 << 30;

fn within_limit(parts: [i32; 3]) -> [i32; 3] {
    parts.map(|part| part.clamp(-LIMIT, LIMIT - 1))
}

/// What an accelerometer measures, in its counts, body frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Force([i32; 3]);

impl Force {
    /// As the sensor reports it.
    #[inline(always)]
    pub fn from_counts(counts: [i16; 3]) -> Self {
        Self(counts.map(|count| i32::from(count) << 15))
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
    pub(super) fn vector<M: super::multiply::Multiply>(self) -> Vector<M, 15> {
        Vector::from_bits(self.0)
    }
}

/// What a magnetometer measures, µT, body frame, corrected for iron.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field([i32; 3]);

impl Field {
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
    pub(super) fn vector<M: super::multiply::Multiply>(self) -> Vector<M, 15> {
        Vector::from_bits(self.0)
    }
}
