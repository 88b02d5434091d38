//! What a real sensor adds to a motion: a gyroscope that does not read zero at rest, and noise.

use super::{Instant, Motion};
use crate::random::normal_pair;

/// How often the noise changes (Hz): the fastest the sensor samples behind its digital filter, so
/// that two of its samples never share their noise.
const NOISE_RATE: f64 = 8000.0;

/// The errors of a sensor.
///
/// The defaults are those of an ordinary MPU-9250: its zero-rate output is within ±5 °/s and its
/// noise 0.1 °/s rms at 92 Hz (datasheet table 1); the accelerometer's 300 µg/√Hz make 0.03 m/s²
/// in the same bandwidth (table 2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Imperfections {
    /// What the gyroscope reads at rest, about the body axes (°/s).
    pub gyro_bias_dps: [f64; 3],
    /// Noise of each gyroscope axis (°/s rms), normally distributed.
    pub gyro_noise_dps: f64,
    /// Noise of each accelerometer axis (m/s² rms), normally distributed.
    pub accel_noise: f64,
    /// Which noise it is: the same seed gives the same noise at the same instants.
    pub seed: u64,
}

impl Imperfections {
    /// A perfect sensor, to build others from.
    pub const NONE: Self = Self {
        gyro_bias_dps: [0.0; 3],
        gyro_noise_dps: 0.0,
        accel_noise: 0.0,
        seed: 0,
    };
}

impl Default for Imperfections {
    fn default() -> Self {
        Self {
            gyro_bias_dps: [0.8, -0.5, 0.3],
            gyro_noise_dps: 0.1,
            accel_noise: 0.03,
            seed: 1,
        }
    }
}

/// Any motion as an imperfect sensor feels it. The truth stays the truth.
pub struct Imperfect {
    motion: Box<dyn Motion>,
    imperfections: Imperfections,
}

impl Imperfect {
    /// Adds `imperfections` to `motion`.
    pub fn new(motion: Box<dyn Motion>, imperfections: Imperfections) -> Self {
        Self {
            motion,
            imperfections,
        }
    }
}

impl Motion for Imperfect {
    fn at(&self, t: f64) -> Instant {
        let Imperfections {
            gyro_bias_dps,
            gyro_noise_dps,
            accel_noise,
            seed,
        } = self.imperfections;
        let mut instant = self.motion.at(t);
        // Rounded, not cut: the instants of a sensor that samples on this grid are never exact.
        let index = (t.max(0.0) * NOISE_RATE).round() as u64;
        for (axis, bias) in gyro_bias_dps.into_iter().enumerate() {
            let [gyro, accel] = normal_pair(seed, index, axis as u64);
            instant.rate[axis] += (bias + gyro_noise_dps * gyro).to_radians();
            instant.force[axis] += accel_noise * accel;
        }
        instant
    }

    fn duration(&self) -> Option<f64> {
        self.motion.duration()
    }

    fn describe(&self) -> String {
        let Imperfections {
            gyro_bias_dps: [x, y, z],
            gyro_noise_dps,
            accel_noise,
            ..
        } = self.imperfections;
        format!(
            "{}; gyroscope bias {x}, {y}, {z} °/s, noise {gyro_noise_dps} °/s and {accel_noise} m/s²",
            self.motion.describe()
        )
    }
}
