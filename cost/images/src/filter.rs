//! What a filter has to do to be counted, and what all of them are told.

use vrduino::sensor::{AccelRange, GyroRange, Ranges, RawSample};

/// What the sensors were set to.
pub const RANGES: Ranges = Ranges {
    gyro: GyroRange::Dps2000,
    accel: AccelRange::G2,
};

/// From one sample to the next, in seconds.
pub const PERIOD_S: f64 = 1e-3;

/// What the gyro reads at rest, in 2⁻¹⁵ counts.
pub const BIAS_PARTS: [i32; 3] = [1_234_567, -765_432, 98_765];

/// The same in °/s.
pub const BIAS_DPS: [f64; 3] = {
    const fn dps(parts: i32) -> f64 {
        parts as f64 * 2000.0 / (1_u32 << 30) as f64
    }
    [dps(BIAS_PARTS[0]), dps(BIAS_PARTS[1]), dps(BIAS_PARTS[2])]
};

/// One sample of the three sensors: gyro at ±2000 °/s, accelerometer at ±2 g, magnetometer at 0.15 µT a count in its
/// own axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Gyro and accelerometer.
    pub sample: RawSample,
    /// The field as of the last time it was measured.
    pub field: [i16; 3],
    /// Whether that was at this sample.
    pub field_is_new: bool,
}

/// A filter from counts to an orientation. What the update takes is what is counted: the way from counts to units is
/// part of it.
pub trait Filter {
    /// As it is when the first sample comes: from the identity.
    fn start() -> Self;

    /// One sample.
    fn update(&mut self, counts: &Counts);

    /// Body to world: w, x, y, z.
    fn orientation(&self) -> [f64; 4];
}
