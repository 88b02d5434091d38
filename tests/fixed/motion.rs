//! What a sensor on a turning body would report.

use crate::random::Random;
use vrduino::nalgebra::{UnitQuaternion, Vector3};
use vrduino::sensor::{Ranges, RawSample, Sample};
use vrduino::units::{AngularRate, SpecificForce};

/// s.
pub const PERIOD: f64 = 1e-3;

/// A body that turns by sines about each of its axes, and a sensor with noise.
pub struct Motion {
    random: Random,
    pub ranges: Ranges,
    truth: UnitQuaternion<f64>,
    amplitude_dps: [f64; 3],
    hertz: [f64; 3],
    pub bias_dps: [f64; 3],
    /// 1, or none.
    pub noise: f64,
    /// Samples before it moves.
    pub still: usize,
    step: usize,
}

impl Motion {
    pub fn new(
        seed: u64,
        ranges: Ranges,
        start: UnitQuaternion<f64>,
        dps: f64,
        hertz: f64,
    ) -> Self {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        for _ in 0..10 {
            random.unit();
        }
        Self {
            amplitude_dps: [(); 3].map(|()| dps * random.between(0.3, 1.0)),
            hertz: [(); 3].map(|()| hertz * random.between(0.3, 1.0)),
            bias_dps: random.vector(5.0),
            random,
            ranges,
            truth: start,
            noise: 1.0,
            still: 0,
            step: 0,
        }
    }

    /// About normal, with a deviation of 1.
    fn noise(&mut self) -> f64 {
        ((0..12).map(|_| self.random.unit()).sum::<f64>() - 6.0) * self.noise
    }

    pub fn next(&mut self) -> RawSample {
        let t = self.step.saturating_sub(self.still) as f64 * PERIOD;
        self.step += 1;
        let axes = Vector3::new(0, 1, 2);
        let dps = axes.map(|axis: usize| {
            self.amplitude_dps[axis] * (core::f64::consts::TAU * self.hertz[axis] * t).sin()
        });
        self.truth *= UnitQuaternion::from_scaled_axis(dps * (PERIOD.to_radians()));
        let up = self.truth.inverse() * Vector3::y();
        let measured_dps = dps + axes.map(|axis: usize| self.bias_dps[axis] + 0.1 * self.noise());
        let measured_g = up + axes.map(|_: usize| 0.005 * self.noise());
        self.ranges.counts(&Sample {
            rate: AngularRate::from_dps(measured_dps),
            force: SpecificForce::from_g(measured_g),
        })
    }

    /// In 2⁻¹⁵ counts, as a measurement of it would have it.
    pub fn bias_parts(&self) -> [i32; 3] {
        let parts_per_dps = f64::from(1 << 30) / self.ranges.gyro.max_dps();
        self.bias_dps.map(|dps| (dps * parts_per_dps) as i32)
    }

    /// 20 µT north and 40 µT down, in 2⁻¹⁵ µT of the body.
    pub fn field(&mut self) -> [i32; 3] {
        let field = self.truth.inverse() * Vector3::new(0.0, -40.0, -20.0);
        let measured = field + Vector3::from([(); 3].map(|()| 0.3 * self.noise()));
        measured.map(|part| (part * 32768.0).round() as i32).into()
    }
}
