//! The individual: what distinguishes one part from the next, within the limits of the data sheets.

use crate::random::{mix, normal_pair, unit};

/// The temperature at which the data sheets state their figures (°C).
pub const REFERENCE_CELSIUS: f64 = 25.0;

/// Errors of three like axes. The unit is °/s for the gyroscope and g for the accelerometer, as in the product
/// specification, tables 1 and 2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Axes {
    /// Output at rest.
    pub bias: [f64; 3],
    /// Its change per kelvin away from [`REFERENCE_CELSIUS`].
    pub bias_per_kelvin: [f64; 3],
    /// Relative error of the scale.
    pub scale: [f64; 3],
    /// Its change per kelvin.
    pub scale_per_kelvin: [f64; 3],
    /// What each axis (row) picks up of the others (column); the diagonal is not used.
    pub cross_axis: [[f64; 3]; 3],
    /// Spectral density of the noise, in the unit per √Hz.
    pub noise_density: f64,
}

impl Axes {
    /// What the axes put out for a true input.
    pub fn apply(&self, input: [f64; 3], kelvin: f64) -> [f64; 3] {
        std::array::from_fn(|row| {
            let scale = 1.0 + self.scale[row] + self.scale_per_kelvin[row] * kelvin;
            let picked_up: f64 = (0..3)
                .filter(|&column| column != row)
                .map(|column| self.cross_axis[row][column] * input[column])
                .sum();
            scale * input[row] + picked_up + self.bias[row] + self.bias_per_kelvin[row] * kelvin
        })
    }
}

/// Errors of the magnetometer, in its own axes (AK8963 data sheet, section 5.3.3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Magnetic {
    /// Output without a field (µT).
    pub offset: [f64; 3],
    /// Relative error of the scale that is left after adjustment.
    pub scale: [f64; 3],
    /// The fuse ROM's ASAX, ASAY, ASAZ: the raw output is the true one divided by what they stand for.
    pub adjustment: [u8; 3],
    /// Noise of one measurement (µT rms). The data sheet states none.
    pub noise: f64,
    /// Relative error of its clock, which is its own: 0.01 is 1 % fast. The data sheet states none.
    pub clock_error: f64,
}

/// Temperature of the die: `celsius` at power-on, approaching `celsius + warm_up`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Temperature {
    /// At power-on (°C).
    pub celsius: f64,
    /// How much it rises (K).
    pub warm_up: f64,
    /// Time constant of that (s).
    pub time_constant: f64,
}

impl Temperature {
    /// At `t` seconds (°C).
    pub fn at(&self, t: f64) -> f64 {
        if self.warm_up == 0.0 {
            return self.celsius;
        }
        self.celsius + self.warm_up * (1.0 - (-t / self.time_constant).exp())
    }
}

/// Factory self-test codes, and how the response has changed since (application note AN-MPU-9250A-03).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelfTest {
    /// Codes x, y, z.
    pub codes: [u8; 3],
    /// Response today over the factory's.
    pub ratio: [f64; 3],
}

/// A part: its identity and its errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// What WHO_AM_I reads: 0x71 is an MPU-9250.
    pub who_am_i: u8,
    /// Whether there is an AK8963 on the auxiliary bus.
    pub magnetometer: bool,
    /// Which noise it is: the same seed gives the same noise.
    pub seed: u64,
    /// Gyroscope (°/s).
    pub gyro: Axes,
    /// Accelerometer (g).
    pub accel: Axes,
    /// Magnetometer.
    pub magnetic: Magnetic,
    /// Gyroscope self-test.
    pub gyro_self_test: SelfTest,
    /// Accelerometer self-test.
    pub accel_self_test: SelfTest,
    /// Relative error of the clock derived from the gyroscope, CLKSEL 1 to 5.
    pub clock_error: f64,
    /// Relative error of the internal oscillator.
    pub internal_clock_error: f64,
    /// Temperature of the die.
    pub temperature: Temperature,
}

// Limits of the product specification, tables 1, 2 and 4, and of the AK8963 data sheet, section 5.3.3.
const GYRO_BIAS: f64 = 5.0;
/// ±30 °/s from −40 °C to +85 °C, the wider side of which is 65 K from the reference.
const GYRO_BIAS_PER_KELVIN: f64 = 30.0 / 65.0;
const GYRO_SCALE: f64 = 0.03;
const GYRO_SCALE_PER_KELVIN: f64 = 0.04 / 65.0;
const GYRO_NOISE: f64 = 0.01;
const ACCEL_BIAS: [f64; 3] = [0.060, 0.060, 0.080];
const ACCEL_BIAS_PER_KELVIN: f64 = 0.0015;
const ACCEL_SCALE: f64 = 0.03;
const ACCEL_SCALE_PER_KELVIN: f64 = 0.000_26;
const ACCEL_NOISE: f64 = 300e-6;
const CROSS_AXIS: f64 = 0.02;
const MAG_OFFSET: f64 = 500.0 * 0.6;
const MAG_SCALE: f64 = 0.05;
const CLOCK: f64 = 0.01;
const INTERNAL_CLOCK: f64 = 0.02;
/// Chosen: how far ASA lies from 128 on real parts is not documented.
const ADJUSTMENT: f64 = 50.0;

impl Part {
    /// An MPU-9250 without any error but quantisation, at 25 °C.
    pub fn perfect() -> Part {
        Part {
            who_am_i: 0x71,
            magnetometer: true,
            seed: 0,
            gyro: Axes::default(),
            accel: Axes::default(),
            magnetic: Magnetic {
                offset: [0.0; 3],
                scale: [0.0; 3],
                adjustment: [128; 3],
                noise: 0.0,
                clock_error: 0.0,
            },
            // In the middle of what the application note lets pass where the codes are missing: 80 °/s, 450 mg.
            gyro_self_test: SelfTest {
                codes: [140; 3],
                ratio: [1.0; 3],
            },
            accel_self_test: SelfTest {
                codes: [105; 3],
                ratio: [1.0; 3],
            },
            clock_error: 0.0,
            internal_clock_error: 0.0,
            temperature: Temperature {
                celsius: REFERENCE_CELSIUS,
                warm_up: 0.0,
                time_constant: 60.0,
            },
        }
    }

    /// A part as they come: every error drawn from a normal distribution whose 3σ is the data sheet's limit.
    pub fn typical(seed: u64) -> Part {
        Part::drawn(seed, |seed, index| {
            (normal_pair(seed, index, 0)[0] / 3.0).clamp(-1.0, 1.0)
        })
    }

    /// A part that just passes: every error at the data sheet's limit, its sign drawn.
    pub fn worst(seed: u64) -> Part {
        Part::drawn(seed, |seed, index| {
            if unit(mix(mix(seed) ^ index)) < 0.5 {
                -1.0
            } else {
                1.0
            }
        })
    }

    /// A part whose errors are `share` (−1 to 1, by seed and index) of the limits.
    fn drawn(seed: u64, share: impl Fn(u64, u64) -> f64) -> Part {
        let mut index = 0;
        let mut draw = |limit: f64| {
            index += 1;
            limit * share(seed, index)
        };
        let mut three = |limit: f64| [draw(limit), draw(limit), draw(limit)];
        let perfect = Part::perfect();
        Part {
            seed,
            gyro: Axes {
                bias: three(GYRO_BIAS),
                bias_per_kelvin: three(GYRO_BIAS_PER_KELVIN),
                scale: three(GYRO_SCALE),
                scale_per_kelvin: three(GYRO_SCALE_PER_KELVIN),
                cross_axis: [three(CROSS_AXIS), three(CROSS_AXIS), three(CROSS_AXIS)],
                noise_density: GYRO_NOISE,
            },
            accel: Axes {
                bias: {
                    let share = three(1.0);
                    std::array::from_fn(|axis| ACCEL_BIAS[axis] * share[axis])
                },
                bias_per_kelvin: three(ACCEL_BIAS_PER_KELVIN),
                scale: three(ACCEL_SCALE),
                scale_per_kelvin: three(ACCEL_SCALE_PER_KELVIN),
                cross_axis: [three(CROSS_AXIS), three(CROSS_AXIS), three(CROSS_AXIS)],
                noise_density: ACCEL_NOISE,
            },
            magnetic: Magnetic {
                offset: three(MAG_OFFSET),
                scale: three(MAG_SCALE),
                adjustment: three(ADJUSTMENT).map(|away| (128.0 + away).round() as u8),
                noise: 0.0,
                clock_error: 0.0,
            },
            // Half of the way to where the application note fails a part.
            gyro_self_test: SelfTest {
                ratio: three(0.25).map(|change| 1.0 + change),
                ..perfect.gyro_self_test
            },
            accel_self_test: SelfTest {
                ratio: three(0.25).map(|change| 1.0 + change),
                ..perfect.accel_self_test
            },
            clock_error: three(CLOCK)[0],
            internal_clock_error: three(INTERNAL_CLOCK)[0],
            ..perfect
        }
    }

    /// With this identity. An MPU-6500 (0x70) and the clones that answer 0x75 have no magnetometer.
    pub fn who_am_i(self, who_am_i: u8) -> Part {
        Part {
            who_am_i,
            magnetometer: self.magnetometer && !matches!(who_am_i, 0x70 | 0x75),
            ..self
        }
    }

    /// With nothing on the auxiliary bus.
    pub fn without_magnetometer(self) -> Part {
        Part {
            magnetometer: false,
            ..self
        }
    }

    /// With this relative error of the clock it measures by: 0.01 is 1 % fast.
    pub fn clock_error(self, clock_error: f64) -> Part {
        Part {
            clock_error,
            ..self
        }
    }

    /// With this temperature, constant (°C).
    pub fn temperature(self, celsius: f64) -> Part {
        Part {
            temperature: Temperature {
                celsius,
                warm_up: 0.0,
                ..self.temperature
            },
            ..self
        }
    }
}
