//! The digital low-pass filters: a bandwidth and a delay for every setting.
//!
//! The tables give a −3 dB frequency f and a delay. Over the gyroscope's settings 1 to 6 the delay is that of one pole,
//! 1/(2πf), and about 2 ms more; so the model is one pole at f, and a pure delay for the rest.

use std::f64::consts::TAU;

use super::registers::{ACCEL_CONFIG_2, CONFIG, GYRO_CONFIG, Registers};

/// What a setting does to the signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Frequency at which a signal is attenuated by 3 dB (Hz).
    pub bandwidth: f64,
    /// Delay of slow signals (s).
    pub delay: f64,
}

const fn response(bandwidth: f64, milliseconds: f64) -> Response {
    Response {
        bandwidth,
        delay: milliseconds / 1000.0,
    }
}

/// DLPF_CFG 0 to 7 (register map, section 4.5, table of CONFIG).
const GYRO: [Response; 8] = [
    response(250.0, 0.97),
    response(184.0, 2.9),
    response(92.0, 3.9),
    response(41.0, 5.9),
    response(20.0, 9.9),
    response(10.0, 17.85),
    response(5.0, 33.48),
    response(3600.0, 0.17),
];

/// The same for the temperature sensor. The last delays are shorter than a single pole allows.
const TEMPERATURE: [Response; 8] = [
    response(4000.0, 0.04),
    response(188.0, 1.9),
    response(98.0, 2.8),
    response(42.0, 4.8),
    response(20.0, 8.3),
    response(10.0, 13.4),
    response(5.0, 18.6),
    response(4000.0, 0.04),
];

/// A_DLPF_CFG 0 to 7: the figures of register map rev. 1.6, as the documentation of the crate `mpu9250` gives them.
/// Section 4.8 of rev. 1.4 has other bandwidths and twice the gyroscope's delays.
const ACCEL: [Response; 8] = [
    response(218.1, 1.88),
    response(218.1, 1.88),
    response(99.0, 2.88),
    response(44.8, 4.88),
    response(21.2, 8.87),
    response(10.2, 16.83),
    response(5.05, 32.48),
    response(420.0, 1.38),
];

/// ACCEL_FCHOICE_B of ACCEL_CONFIG_2, and the response with it.
pub const ACCEL_FCHOICE_B: u8 = 1 << 3;
const ACCEL_BYPASSED: Response = response(1046.0, 0.503);

/// The duty-cycled accelerometer (section 4.8, low-power mode).
pub const ACCEL_LOW_POWER: Response = response(1100.0, 1.0);

/// The gyroscope's present response.
pub fn gyroscope(registers: &Registers) -> Response {
    let fchoice = !registers[GYRO_CONFIG] & 3;
    match fchoice {
        3 => GYRO[usize::from(registers[CONFIG] & 7)],
        1 => response(3600.0, 0.11),
        _ => response(8800.0, 0.064),
    }
}

/// The temperature sensor's present response.
pub fn temperature(registers: &Registers) -> Response {
    match registers[GYRO_CONFIG] & 3 {
        0 => TEMPERATURE[usize::from(registers[CONFIG] & 7)],
        _ => TEMPERATURE[0],
    }
}

/// The accelerometer's present response.
pub fn accelerometer(registers: &Registers) -> Response {
    if registers.has(ACCEL_CONFIG_2, ACCEL_FCHOICE_B) {
        ACCEL_BYPASSED
    } else {
        ACCEL[usize::from(registers[ACCEL_CONFIG_2] & 7)]
    }
}

/// A response as a recurrence at a given step: y += gain (x − y), with x as it was `latency` ago.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recurrence {
    gain: f64,
    /// The pure delay (s).
    pub latency: f64,
}

impl Response {
    /// The recurrence at `hz` steps a second whose attenuation at the bandwidth is exactly 3 dB and whose delay is
    /// that of the response; or the pole's own, where that is longer.
    pub fn at(self, hz: f64) -> Recurrence {
        let c = 1.0 - (TAU * self.bandwidth.min(hz / 2.0) / hz).cos();
        let gain = (c * c + 2.0 * c).sqrt() - c;
        let pole = (1.0 - gain) / (gain * hz);
        Recurrence {
            gain,
            latency: (self.delay - pole).max(0.0),
        }
    }
}

/// The memory of `N` like filters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LowPass<const N: usize> {
    outputs: [f64; N],
    settled: bool,
}

impl<const N: usize> LowPass<N> {
    /// A filter that takes the first input for what was always there.
    pub fn settled() -> Self {
        LowPass {
            outputs: [0.0; N],
            settled: false,
        }
    }

    /// A filter that starts from zero.
    pub fn zero() -> Self {
        LowPass {
            outputs: [0.0; N],
            settled: true,
        }
    }

    /// Takes one input for each.
    pub fn step(&mut self, recurrence: Recurrence, inputs: [f64; N]) {
        if !std::mem::replace(&mut self.settled, true) {
            self.outputs = inputs;
            return;
        }
        for (output, input) in self.outputs.iter_mut().zip(inputs) {
            *output += recurrence.gain * (input - *output);
        }
    }

    /// What they put out.
    pub fn outputs(&self) -> [f64; N] {
        self.outputs
    }
}
