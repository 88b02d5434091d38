//! The sensor: an MPU-9250 on the I2C bus, from its product specification and register map (rev. 1.6).
//!
//! Modelled: register reset values, start-up time, device reset, sleep, gyro and accelerometer ranges, sample rate with
//! its divider, output registers that hold still during a burst, INT_STATUS. Not yet: low-pass filters, FIFO,
//! self-test, magnetometer.

use std::sync::Arc;

use crate::motion::{Instant, Motion};
use crate::peripherals::i2c::Target;
use crate::time::{self, MILLISECOND, Ticks};

/// Bus address with AD0 low.
pub const ADDRESS: u8 = 0x68;

const SMPLRT_DIV: usize = 0x19;
const CONFIG: usize = 0x1A;
const GYRO_CONFIG: usize = 0x1B;
const ACCEL_CONFIG: usize = 0x1C;
const INT_PIN_CFG: usize = 0x37;
const INT_STATUS: usize = 0x3A;
const ACCEL_XOUT_H: usize = 0x3B;
const GYRO_ZOUT_L: usize = 0x48;
const PWR_MGMT_1: usize = 0x6B;
const PWR_MGMT_2: usize = 0x6C;
const WHO_AM_I: usize = 0x75;

const RAW_DATA_RDY: u8 = 1 << 0;
const H_RESET: u8 = 1 << 7;
const SLEEP: u8 = 1 << 6;

/// Registers answer this long after power-on (specification, table 3: 11 ms typical, 100 ms at most).
const START_UP: Ticks = 11 * MILLISECOND;
/// After H_RESET the registers are back at their defaults; the same start-up is assumed.
const RESET_TIME: Ticks = 11 * MILLISECOND;

/// Standard gravity as the specification's g.
const G: f64 = 9.80665;
/// Die temperature: 25 °C, in counts (333.87 LSB/°C above 21 °C).
const TEMPERATURE: i16 = 1335;

/// What is wrong with the sensor or its wires, for tests and `--fault`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Faults {
    /// Nothing answers.
    pub absent: bool,
    /// The sensor no longer takes new samples.
    pub frozen: bool,
}

/// One burst that the firmware read, as the registers held it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Burst {
    /// When INT_STATUS was read.
    pub at: Ticks,
    /// INT_STATUS, accelerometer, temperature, gyroscope: 0x3A to 0x48.
    pub bytes: [u8; 15],
}

/// The sensor.
#[derive(Debug, Clone)]
pub struct Mpu9250 {
    registers: [u8; 128],
    /// Output registers as the running transfer sees them.
    shadow: [u8; 14],
    who_am_i: u8,
    motion: Arc<dyn Motion>,
    /// Error of the sensor's own oscillator, e.g. 0.01 for 1 % fast.
    clock_error: f64,
    ready_at: Ticks,
    /// Since when samples are taken, and how many there were.
    sampling_since: Ticks,
    samples: u64,
    pointer: usize,
    first_byte: bool,
    /// Present faults.
    pub faults: Faults,
    /// Every burst from INT_STATUS on, once recording was asked for.
    pub recording: Option<Vec<Burst>>,
    burst: Option<(Ticks, Vec<u8>)>,
}

impl Mpu9250 {
    /// A sensor that has just been powered, moved by `motion`.
    pub fn new(motion: Arc<dyn Motion>, who_am_i: u8, clock_error: f64) -> Mpu9250 {
        let mut sensor = Mpu9250 {
            registers: [0; 128],
            shadow: [0; 14],
            who_am_i,
            motion,
            clock_error,
            ready_at: START_UP,
            sampling_since: 0,
            samples: 0,
            pointer: 0,
            first_byte: false,
            faults: Faults::default(),
            recording: None,
            burst: None,
        };
        sensor.reset_registers(0);
        sensor
    }

    fn reset_registers(&mut self, now: Ticks) {
        self.registers = [0; 128];
        self.registers[PWR_MGMT_1] = 0x01;
        self.registers[WHO_AM_I] = self.who_am_i;
        self.sampling_since = now;
        self.samples = 0;
    }

    /// The sensor loses power for a moment.
    pub fn brown_out(&mut self, now: Ticks) {
        self.reset_registers(now);
        self.ready_at = now + START_UP;
    }

    /// Output data rate: 1 kHz behind the divider with the low-pass filter in use, 8 kHz without (register 0x1A).
    fn sample_hz(&self) -> f64 {
        let filter = self.registers[CONFIG] & 7;
        let bypassed = self.registers[GYRO_CONFIG] & 3 != 0;
        let hz = match (bypassed, filter) {
            (true, _) => 32_000.0,
            (false, 0 | 7) => 8_000.0,
            _ => 1_000.0 / (f64::from(self.registers[SMPLRT_DIV]) + 1.0),
        };
        hz * (1.0 + self.clock_error)
    }

    /// Takes the samples that are due; only the last of them is ever seen.
    fn advance(&mut self, now: Ticks) {
        let since = self.sampling_since;
        if self.faults.frozen || self.registers[PWR_MGMT_1] & SLEEP != 0 {
            return;
        }
        let hz = self.sample_hz();
        let due = (time::seconds(now.saturating_sub(since)) * hz).floor() as u64;
        if due > self.samples {
            self.samples = due;
            let at = time::seconds(since) + due as f64 / hz;
            let instant = self.motion.at(at);
            self.measure(&instant);
            self.registers[INT_STATUS] |= RAW_DATA_RDY;
        }
    }

    fn measure(&mut self, instant: &Instant) {
        let accel_range = f64::from(2u32 << (self.registers[ACCEL_CONFIG] >> 3 & 3)) * G;
        let gyro_range = f64::from(250u32 << (self.registers[GYRO_CONFIG] >> 3 & 3)).to_radians();
        let counts = |value: f64, range: f64| {
            (value / range * 32_768.0)
                .round()
                .clamp(-32_768.0, 32_767.0) as i16
        };
        let disabled = self.registers[PWR_MGMT_2];
        let axis = |bit: u8, value: i16| if disabled >> bit & 1 != 0 { 0 } else { value };
        let outputs = [
            axis(5, counts(instant.force[0], accel_range)),
            axis(4, counts(instant.force[1], accel_range)),
            axis(3, counts(instant.force[2], accel_range)),
            TEMPERATURE,
            axis(2, counts(instant.rate[0], gyro_range)),
            axis(1, counts(instant.rate[1], gyro_range)),
            axis(0, counts(instant.rate[2], gyro_range)),
        ];
        for (register, byte) in
            (ACCEL_XOUT_H..).zip(outputs.iter().flat_map(|value| value.to_be_bytes()))
        {
            self.registers[register] = byte;
        }
    }

    fn read_register(&mut self, register: usize) -> u8 {
        match register {
            ACCEL_XOUT_H..=GYRO_ZOUT_L => self.shadow[register - ACCEL_XOUT_H],
            INT_STATUS => std::mem::take(&mut self.registers[INT_STATUS]),
            _ => {
                if self.registers[INT_PIN_CFG] & 0x10 != 0 {
                    self.registers[INT_STATUS] = 0;
                }
                self.registers[register]
            }
        }
    }

    fn write_register(&mut self, register: usize, value: u8, now: Ticks) {
        match register {
            PWR_MGMT_1 if value & H_RESET != 0 => {
                self.reset_registers(now);
                self.ready_at = now + RESET_TIME;
            }
            ACCEL_XOUT_H..=GYRO_ZOUT_L | INT_STATUS | WHO_AM_I => {}
            _ => {
                self.registers[register] = value;
                if [SMPLRT_DIV, CONFIG, GYRO_CONFIG, PWR_MGMT_1].contains(&register) {
                    self.sampling_since = now;
                    self.samples = 0;
                }
            }
        }
    }

    fn end_burst(&mut self) {
        if let Some((at, bytes)) = self.burst.take()
            && let Some(recording) = &mut self.recording
            && let Ok(bytes) = bytes.try_into()
        {
            recording.push(Burst { at, bytes });
        }
    }
}

impl Target for Mpu9250 {
    fn address(&mut self, byte: u8, now: Ticks) -> bool {
        self.end_burst();
        if self.faults.absent || byte >> 1 != ADDRESS || now < self.ready_at {
            return false;
        }
        self.first_byte = true;
        self.advance(now);
        // The output registers do not change while the serial interface is busy (specification 4.16).
        self.shadow
            .copy_from_slice(&self.registers[ACCEL_XOUT_H..=GYRO_ZOUT_L]);
        if byte & 1 != 0 && self.pointer == INT_STATUS {
            self.burst = Some((now, Vec::with_capacity(15)));
        }
        true
    }

    fn write(&mut self, byte: u8, now: Ticks) -> bool {
        if self.faults.absent {
            return false;
        }
        if std::mem::take(&mut self.first_byte) {
            self.pointer = usize::from(byte & 0x7F);
        } else {
            self.write_register(self.pointer, byte, now);
            self.pointer = (self.pointer + 1) % 128;
        }
        true
    }

    fn read(&mut self, _now: Ticks) -> u8 {
        if self.faults.absent {
            return 0xFF;
        }
        let byte = self.read_register(self.pointer);
        self.pointer = (self.pointer + 1) % 128;
        if let Some((_, bytes)) = &mut self.burst {
            bytes.push(byte);
        }
        byte
    }

    fn stop(&mut self) {
        self.end_burst();
    }
}
