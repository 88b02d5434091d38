//! The magnetometer: an AK8963, a die of its own with its own address (data sheet MS1356-E-02).

mod measurement;

use std::sync::Arc;

use super::Faults;
use super::complaint::{Complaint, Complaints};
use super::part::Magnetic;
use crate::motion::Motion;
use crate::time::{MICROSECOND, Ticks};
use measurement::Measurement;

/// Its bus address in the MPU-9250.
pub const ADDRESS: u8 = 0x0C;

const WIA: u8 = 0x48;
/// INFO is not documented; parts answer this.
const INFO: u8 = 0x9A;
const ST1: u8 = 0x02;
const HXL: u8 = 0x03;
const HZH: u8 = 0x08;
const ST2: u8 = 0x09;
const CNTL1: u8 = 0x0A;
const CNTL2: u8 = 0x0B;
const ASTC: u8 = 0x0C;
const I2CDIS: u8 = 0x0F;
const ASAX: u8 = 0x10;
const ASAZ: u8 = 0x12;

const SELF: u8 = 1 << 6;
const BIT: u8 = 1 << 4;
const DISABLE_I2C: u8 = 0x1B;

/// Between power-down and another mode (section 5.3.2, Twat).
const MODE_WAIT: Ticks = 100 * MICROSECOND;

/// MODE of CNTL1 (section 8.3.6).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    PowerDown = 0b0000,
    Single = 0b0001,
    Continuous8Hz = 0b0010,
    ExternalTrigger = 0b0100,
    Continuous100Hz = 0b0110,
    SelfTest = 0b1000,
    FuseRom = 0b1111,
}

impl Mode {
    fn of(bits: u8) -> Option<Mode> {
        [
            Mode::PowerDown,
            Mode::Single,
            Mode::Continuous8Hz,
            Mode::ExternalTrigger,
            Mode::Continuous100Hz,
            Mode::SelfTest,
            Mode::FuseRom,
        ]
        .into_iter()
        .find(|mode| *mode as u8 == bits)
    }
}

/// The magnetometer.
#[derive(Debug, Clone)]
pub struct Ak8963 {
    measurement: Measurement,
    mode: Mode,
    sixteen_bits: bool,
    self_test_control: u8,
    powered_down_at: Ticks,
    silenced: bool,
    pointer: u8,
    first_byte: bool,
    /// Present faults.
    pub faults: Faults,
}

impl Ak8963 {
    /// A magnetometer in power-down, since `now`.
    pub fn new(motion: Arc<dyn Motion>, part: Magnetic, seed: u64, now: Ticks) -> Ak8963 {
        Ak8963 {
            measurement: Measurement::new(motion, part, seed),
            mode: Mode::PowerDown,
            sixteen_bits: false,
            self_test_control: 0,
            powered_down_at: now,
            silenced: false,
            pointer: 0,
            first_byte: false,
            faults: Faults::default(),
        }
    }

    /// Soft reset, or power-on reset: all registers are initialised (section 6.2).
    pub fn reset(&mut self, now: Ticks) {
        self.measurement.reset();
        self.mode = Mode::PowerDown;
        self.sixteen_bits = false;
        self.self_test_control = 0;
        self.powered_down_at = now;
        self.silenced = false;
    }

    /// Whether it acknowledges its address.
    pub fn answers(&self) -> bool {
        !self.silenced && !self.faults.absent
    }

    /// Its address after a START.
    pub fn address(&mut self) {
        self.first_byte = true;
    }

    /// A byte written to it.
    pub fn write(&mut self, byte: u8, now: Ticks, complaints: &mut Complaints) {
        if std::mem::take(&mut self.first_byte) {
            self.pointer = byte;
            return;
        }
        self.advance(now);
        self.write_register(self.pointer, byte, now, complaints);
        self.increment();
    }

    /// A byte read from it.
    pub fn read(&mut self, now: Ticks, complaints: &mut Complaints) -> u8 {
        self.advance(now);
        let byte = self.read_register(self.pointer, now, complaints);
        self.increment();
        byte
    }

    /// 00H to 0CH and 10H to 12H are two rings (section 7.2).
    fn increment(&mut self) {
        self.pointer = match self.pointer {
            ASTC => 0,
            ASAZ => ASAX,
            other => other.wrapping_add(1),
        };
    }

    fn advance(&mut self, now: Ticks) {
        if !self.faults.frozen && self.measurement.advance(now) {
            // Single measurement and self-test end in power-down (sections 6.4.2 and 6.4.5).
            self.mode = Mode::PowerDown;
        }
    }

    fn read_register(&mut self, register: u8, now: Ticks, complaints: &mut Complaints) -> u8 {
        match register {
            0x00 => WIA,
            0x01 => INFO,
            ST1 => self.measurement.status(),
            HXL..=HZH => {
                let protects = matches!(
                    self.mode,
                    Mode::Continuous8Hz | Mode::Continuous100Hz | Mode::ExternalTrigger
                );
                if register == HXL && self.measurement.is_stale() {
                    complaints.note(now, Complaint::MagStatus2NotRead);
                }
                self.measurement.read_data(register - HXL, protects)
            }
            ST2 => self.measurement.read_end(self.sixteen_bits),
            CNTL1 => self.mode as u8 | if self.sixteen_bits { BIT } else { 0 },
            CNTL2 => 0,
            ASTC => self.self_test_control,
            I2CDIS => 0,
            ASAX..=ASAZ => {
                if self.mode == Mode::FuseRom {
                    self.measurement.part.adjustment[usize::from(register - ASAX)]
                } else {
                    complaints.note(now, Complaint::MagFuseRomClosed);
                    0
                }
            }
            _ => {
                complaints.note(now, Complaint::MagReservedRegister(register));
                0
            }
        }
    }

    fn write_register(&mut self, register: u8, value: u8, now: Ticks, complaints: &mut Complaints) {
        match register {
            CNTL1 => self.set_mode(value, now, complaints),
            CNTL2 if value & 1 != 0 => self.reset(now),
            CNTL2 => {}
            ASTC => {
                self.self_test_control = value;
                if value & !SELF != 0 {
                    complaints.note(now, Complaint::MagReservedSelfTestBit);
                }
            }
            I2CDIS if value == DISABLE_I2C => {
                self.silenced = true;
                complaints.note(now, Complaint::MagI2cDisabled);
            }
            I2CDIS => {}
            0x00..=ST2 | ASAX..=ASAZ => {
                complaints.note(now, Complaint::MagReadOnlyRegister(register));
            }
            _ => complaints.note(now, Complaint::MagReservedRegister(register)),
        }
    }

    /// A mode is entered from power-down, 100 µs after it, or not at all.
    fn set_mode(&mut self, value: u8, now: Ticks, complaints: &mut Complaints) {
        let Some(mode) = Mode::of(value & 0xF) else {
            complaints.note(now, Complaint::MagModeProhibited(value & 0xF));
            return;
        };
        if mode == Mode::PowerDown {
            self.sixteen_bits = value & BIT != 0;
            self.mode = mode;
            self.powered_down_at = now;
            self.measurement.stop();
            return;
        }
        if self.mode != Mode::PowerDown && self.mode != mode {
            complaints.note(
                now,
                Complaint::MagModeWithoutPowerDown {
                    from: self.mode as u8,
                    to: mode as u8,
                },
            );
            return;
        }
        if self.mode == Mode::PowerDown && now < self.powered_down_at + MODE_WAIT {
            complaints.note(now, Complaint::MagModeTooSoon);
            return;
        }
        self.sixteen_bits = value & BIT != 0;
        self.mode = mode;
        if mode == Mode::SelfTest && self.self_test_control & SELF == 0 {
            complaints.note(now, Complaint::MagSelfTestWithoutField);
        }
        let broken = self.self_test_control & !SELF != 0;
        let actuated = mode == Mode::SelfTest && self.self_test_control & SELF != 0;
        self.measurement
            .configure(self.sixteen_bits, actuated, broken);
        match mode {
            Mode::Single | Mode::SelfTest => self.measurement.start(now, None),
            Mode::Continuous8Hz => self.measurement.start(now, Some(8)),
            Mode::Continuous100Hz => self.measurement.start(now, Some(100)),
            // The trigger pin is not connected inside the MPU-9250, so no measurement ever comes.
            Mode::ExternalTrigger | Mode::FuseRom | Mode::PowerDown => self.measurement.stop(),
        }
    }
}
