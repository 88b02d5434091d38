//! From what the sensor feels to counts: errors of the part, noise, filters, offsets, range and quantisation.

use std::sync::Arc;

use super::low_pass::{self, LowPass, Recurrence};
use super::part::{Part, REFERENCE_CELSIUS};
use super::registers::{
    ACCEL_CONFIG, ACCEL_CONFIG_2, GYRO_CONFIG, PWR_MGMT_1, PWR_MGMT_2, Registers, XA_OFFSET_H,
    XG_OFFSET_H,
};
use super::sampling::{Mode, STANDBY, Schedule};
use super::self_test;
use crate::motion::Motion;
use crate::random::{mix, normal_pair};
use crate::time::{self, Ticks};

/// The unit g (m/s²).
const G: f64 = 9.806_65;
/// Counts per unit at the smallest range: ±250 °/s and ±2 g.
const GYRO_COUNTS: f64 = 32_768.0 / 250.0;
const ACCEL_COUNTS: f64 = 32_768.0 / 2.0;
/// Counts per kelvin, and where they are zero (product specification, table 4; register map 4.23).
const TEMPERATURE_COUNTS: f64 = 333.87;
const TEMPERATURE_ZERO: f64 = 21.0;
/// Weight of the last bit of an accelerometer offset register (g; register map 4.39).
const ACCEL_OFFSET: f64 = 0.98e-3;

const PD_PTAT: u8 = 1 << 3;

/// Since when the sensing elements deliver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Started {
    /// Gyroscope.
    pub gyro: Ticks,
    /// Accelerometer.
    pub accel: Ticks,
}

/// A sample in counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Counts {
    /// Accelerometer.
    pub accel: [i16; 3],
    /// Temperature.
    pub temperature: i16,
    /// Gyroscope.
    pub gyro: [i16; 3],
}

/// Sensing elements and filters.
#[derive(Debug, Clone)]
pub struct SignalPath {
    motion: Arc<dyn Motion>,
    part: Part,
    gyro: LowPass<3>,
    accel: LowPass<3>,
    temperature: LowPass<1>,
    recurrences: [Recurrence; 3],
    /// The accelerometer's output, renewed every so many steps: 1 kHz behind its filter, 4 kHz without.
    accel_output: [f64; 3],
    accel_steps: u64,
    mode: Mode,
    /// Noise of one step over the noise density: √(step rate / 2).
    noise_bandwidth: f64,
    noise_seed: u64,
}

impl SignalPath {
    /// The path of a part that is moved by `motion`.
    pub fn new(motion: Arc<dyn Motion>, part: Part) -> SignalPath {
        SignalPath {
            motion,
            part,
            gyro: LowPass::settled(),
            accel: LowPass::settled(),
            temperature: LowPass::settled(),
            recurrences: [low_pass::ACCEL_LOW_POWER.at(8_000.0); 3],
            accel_output: [0.0; 3],
            accel_steps: 1,
            mode: Mode::Stopped,
            noise_bandwidth: 0.0,
            noise_seed: 0,
        }
    }

    /// Takes over settings: filters for a schedule that began at `since`.
    pub fn configure(&mut self, registers: &Registers, schedule: Schedule, since: Ticks) {
        let hz = schedule.step_hz;
        self.mode = schedule.mode;
        if self.mode == Mode::Cycle {
            // A single sample has gone through the element's own bandwidth, not through a digital filter.
            let response = low_pass::ACCEL_LOW_POWER;
            self.noise_bandwidth = (response.bandwidth * std::f64::consts::FRAC_PI_2).sqrt();
            self.recurrences[1].latency = response.delay;
            self.accel_steps = 1;
        } else {
            self.noise_bandwidth = (hz / 2.0).sqrt();
            self.recurrences = [
                low_pass::gyroscope(registers),
                low_pass::accelerometer(registers),
                low_pass::temperature(registers),
            ]
            .map(|response| response.at(hz));
            let bypassed = registers.has(ACCEL_CONFIG_2, low_pass::ACCEL_FCHOICE_B);
            self.accel_steps = (hz / if bypassed { 4_000.0 } else { 1_000.0 }) as u64;
        }
        self.noise_seed = mix(self.part.seed ^ mix(since));
    }

    /// Forgets the past: the filters take the next input for what was always there.
    pub fn settle(&mut self) {
        self.gyro = LowPass::settled();
        self.accel = LowPass::settled();
        self.accel_output = [0.0; 3];
        self.temperature = LowPass::settled();
    }

    /// The same for a gyroscope that was turned off alone.
    pub fn settle_gyro(&mut self) {
        self.gyro = LowPass::settled();
    }

    /// SIGNAL_PATH_RESET (register map 4.31): bit 2 gyroscope, bit 1 accelerometer, bit 0 temperature.
    pub fn reset(&mut self, bits: u8) {
        if bits & 4 != 0 {
            self.gyro = LowPass::zero();
        }
        if bits & 2 != 0 {
            self.accel = LowPass::zero();
        }
        if bits & 1 != 0 {
            self.temperature = LowPass::zero();
        }
    }

    /// One internal step, the `index`th of its schedule, at `at`.
    pub fn step(&mut self, index: u64, at: Ticks, registers: &Registers, started: Started) {
        let t = time::seconds(at);
        let celsius = self.part.temperature.at(t);
        let kelvin = celsius - REFERENCE_CELSIUS;
        if at >= started.accel || self.mode == Mode::Cycle {
            let felt = self.motion.at((t - self.recurrences[1].latency).max(0.0));
            let part = &self.part;
            let actuation =
                self_test::response(&part.accel_self_test, registers[ACCEL_CONFIG], ACCEL_COUNTS);
            let noise = self.noise(index, 0, part.accel.noise_density);
            let input = part.accel.apply(felt.force.map(|force| force / G), kelvin);
            if self.mode == Mode::Cycle {
                self.accel = LowPass::settled();
            }
            self.accel
                .step(self.recurrences[1], sum(input, actuation, noise));
            if index.is_multiple_of(self.accel_steps) {
                self.accel_output = self.accel.outputs();
            }
        }
        if self.mode == Mode::Cycle {
            return;
        }
        if at >= started.gyro {
            let felt = self.motion.at((t - self.recurrences[0].latency).max(0.0));
            let part = &self.part;
            let actuation =
                self_test::response(&part.gyro_self_test, registers[GYRO_CONFIG], GYRO_COUNTS);
            let noise = self.noise(index, 1, part.gyro.noise_density);
            let input = part.gyro.apply(felt.rate.map(f64::to_degrees), kelvin);
            self.gyro
                .step(self.recurrences[0], sum(input, actuation, noise));
        }
        self.temperature.step(self.recurrences[2], [celsius]);
    }

    /// White noise of three axes in one step.
    fn noise(&self, index: u64, element: u64, density: f64) -> [f64; 3] {
        if density == 0.0 {
            return [0.0; 3];
        }
        let [x, y] = normal_pair(self.noise_seed, index, 2 * element);
        let [z, _] = normal_pair(self.noise_seed, index, 2 * element + 1);
        [x, y, z].map(|normal| normal * density * self.noise_bandwidth)
    }

    /// What the output registers get of the filters' outputs.
    pub fn counts(&self, registers: &Registers) -> Counts {
        let disabled = registers[PWR_MGMT_2];
        let enabled = |bit: usize| disabled >> bit & 1 == 0;
        let standby = registers.has(PWR_MGMT_1, STANDBY);
        let gyro_scale = f64::from(1u32 << registers.full_scale(GYRO_CONFIG));
        let accel_scale = f64::from(1u32 << registers.full_scale(ACCEL_CONFIG));
        let (gyro, accel) = (self.gyro.outputs(), self.accel_output);
        let [celsius] = self.temperature.outputs();
        Counts {
            accel: std::array::from_fn(|axis| {
                let offset = registers.word(XA_OFFSET_H + 3 * axis as u8) >> 1;
                let value = accel[axis] + f64::from(offset) * ACCEL_OFFSET;
                if enabled(5 - axis) {
                    quantised(value * ACCEL_COUNTS / accel_scale)
                } else {
                    0
                }
            }),
            temperature: if registers.has(PWR_MGMT_1, PD_PTAT) {
                0
            } else {
                quantised((celsius - TEMPERATURE_ZERO) * TEMPERATURE_COUNTS)
            },
            gyro: std::array::from_fn(|axis| {
                // Four counts of the smallest range (register map 4.3), added as the maker's own driver expects.
                let offset = f64::from(registers.word(XG_OFFSET_H + 2 * axis as u8)) * 4.0;
                if enabled(2 - axis) && !standby {
                    quantised((gyro[axis] * GYRO_COUNTS + offset) / gyro_scale)
                } else {
                    0
                }
            }),
        }
    }
}

fn sum(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] + b[axis] + c[axis])
}

/// The nearest count; the ends of the range stand for everything beyond.
fn quantised(counts: f64) -> i16 {
    counts.round().clamp(-32_768.0, 32_767.0) as i16
}
