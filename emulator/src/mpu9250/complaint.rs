//! What a driver did that the part does not forgive, and does not report either.

use std::fmt;

use crate::time::Ticks;
use crate::witness::Trap;

/// A misuse of the sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Complaint {
    /// A write to a register that the map does not name.
    ReservedRegister(u8),
    /// A write to a register that can only be read.
    ReadOnlyRegister(u8),
    /// An access within the start-up time after H_RESET.
    BusyAfterReset,
    /// The gyroscope's output was read before it had started.
    GyroNotStarted,
    /// FIFO_R_W was read with nothing in the FIFO.
    FifoEmpty,
    /// FIFO_R_W was read with the FIFO disabled.
    FifoDisabled,
    /// I2C_IF_DIS was set on an I2C bus.
    I2cDisabled,
    /// I2C_MST_RST was set while the auxiliary master was busy.
    MasterResetWhileBusy,
    /// A reserved rate of the low-power accelerometer mode.
    ReservedAccelRate(u8),
    /// The magnetometer was taken from one mode to another without power-down between.
    MagModeWithoutPowerDown {
        /// MODE before.
        from: u8,
        /// MODE wanted.
        to: u8,
    },
    /// The magnetometer's mode was set less than 100 µs after power-down.
    MagModeTooSoon,
    /// A mode of the magnetometer that is prohibited.
    MagModeProhibited(u8),
    /// The magnetometer's fuse ROM was read in another mode than its own.
    MagFuseRomClosed,
    /// Self-test mode without the field for it (SELF in ASTC).
    MagSelfTestWithoutField,
    /// A bit other than SELF was set in ASTC.
    MagReservedSelfTestBit,
    /// A test or reserved register of the magnetometer was accessed.
    MagReservedRegister(u8),
    /// A write to a register of the magnetometer that can only be read.
    MagReadOnlyRegister(u8),
    /// The magnetometer's data was read again without ST2, so that it no longer changes.
    MagStatus2NotRead,
    /// The magnetometer's I2C interface was disabled.
    MagI2cDisabled,
}

impl Complaint {
    /// The trap that stops a program which does this; `None` if it only gets worse data.
    pub fn trap(self) -> Option<Trap> {
        Some(match self {
            Complaint::GyroNotStarted => return None,
            Complaint::ReservedRegister(_)
            | Complaint::ReservedAccelRate(_)
            | Complaint::MagReservedRegister(_)
            | Complaint::MagReservedSelfTestBit => Trap::SensorReserved,
            Complaint::ReadOnlyRegister(_) | Complaint::MagReadOnlyRegister(_) => {
                Trap::SensorReadOnly
            }
            Complaint::BusyAfterReset => Trap::SensorNotReady,
            Complaint::FifoEmpty | Complaint::FifoDisabled => Trap::SensorFifo,
            Complaint::I2cDisabled
            | Complaint::MasterResetWhileBusy
            | Complaint::MagI2cDisabled => Trap::SensorLost,
            Complaint::MagModeWithoutPowerDown { .. }
            | Complaint::MagModeTooSoon
            | Complaint::MagModeProhibited(_)
            | Complaint::MagFuseRomClosed
            | Complaint::MagSelfTestWithoutField => Trap::MagnetometerMode,
            Complaint::MagStatus2NotRead => Trap::MagnetometerStale,
        })
    }

    /// Where the rule is written: PS is the product specification, RM the register map of the MPU-9250, AK the data
    /// sheet of the AK8963.
    pub fn section(self) -> &'static str {
        match self {
            Complaint::ReservedRegister(_) | Complaint::ReadOnlyRegister(_) => "RM 3",
            Complaint::BusyAfterReset => "PS 3.4.2, start-up time for register read/write",
            Complaint::GyroNotStarted => "PS 3.1, gyroscope start-up time",
            Complaint::FifoEmpty => "RM 4.37",
            Complaint::FifoDisabled | Complaint::I2cDisabled | Complaint::MasterResetWhileBusy => {
                "RM 4.33"
            }
            Complaint::ReservedAccelRate(_) => "RM 4.9",
            Complaint::MagModeWithoutPowerDown { .. } => "AK 6.3",
            Complaint::MagModeTooSoon => "AK 5.3.2 and 6.3, Twat",
            Complaint::MagModeProhibited(_) => "AK 8.3.6",
            Complaint::MagFuseRomClosed => "AK 6.4.6 and 8.1",
            Complaint::MagSelfTestWithoutField => "AK 6.4.5",
            Complaint::MagReservedSelfTestBit => "AK 8.3.8",
            Complaint::MagReservedRegister(_) => "AK 8.1",
            Complaint::MagReadOnlyRegister(_) => "AK 8.2",
            Complaint::MagStatus2NotRead => "AK 6.4.3.2",
            Complaint::MagI2cDisabled => "AK 8.3.10",
        }
    }
}

impl fmt::Display for Complaint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Complaint::ReservedRegister(register) => {
                write!(f, "write to the reserved register 0x{register:02X}")
            }
            Complaint::ReadOnlyRegister(register) => {
                write!(f, "write to the read-only register 0x{register:02X}")
            }
            Complaint::BusyAfterReset => {
                f.write_str("access while the sensor starts after H_RESET; wait, it does not answer")
            }
            Complaint::GyroNotStarted => f.write_str(
                "the gyroscope's output was read within 35 ms of its start, when it is not valid",
            ),
            Complaint::FifoEmpty => f.write_str(
                "FIFO_R_W was read with the FIFO empty: the last byte comes again; look at FIFO_COUNT first",
            ),
            Complaint::FifoDisabled => {
                f.write_str("FIFO_R_W was read while FIFO_EN in USER_CTRL is clear")
            }
            Complaint::I2cDisabled => f.write_str(
                "I2C_IF_DIS was set on an I2C bus: the sensor answers SPI only, until it loses power",
            ),
            Complaint::MasterResetWhileBusy => f.write_str(
                "I2C_MST_RST during a transfer on the auxiliary bus: its slave hangs until it loses power",
            ),
            Complaint::ReservedAccelRate(code) => {
                write!(f, "LP_ACCEL_ODR {code} is reserved; the fastest is 11")
            }
            Complaint::MagModeWithoutPowerDown { from, to } => write!(
                f,
                "the magnetometer was taken from mode {from:#06b} to {to:#06b} without power-down between"
            ),
            Complaint::MagModeTooSoon => {
                f.write_str("the magnetometer's mode was set within 100 µs of power-down")
            }
            Complaint::MagModeProhibited(mode) => {
                write!(f, "the magnetometer has no mode {mode:#06b}")
            }
            Complaint::MagFuseRomClosed => f.write_str(
                "ASAX to ASAZ were read outside fuse ROM access mode, where they are not correct",
            ),
            Complaint::MagSelfTestWithoutField => {
                f.write_str("the magnetometer's self-test mode without SELF in ASTC")
            }
            Complaint::MagReservedSelfTestBit => f.write_str(
                "a bit other than SELF was set in ASTC: the magnetometer no longer measures normally",
            ),
            Complaint::MagReservedRegister(register) => write!(
                f,
                "access to the magnetometer's register 0x{register:02X}, which must be left alone"
            ),
            Complaint::MagReadOnlyRegister(register) => write!(
                f,
                "write to the magnetometer's read-only register 0x{register:02X}"
            ),
            Complaint::MagStatus2NotRead => f.write_str(
                "the magnetometer's data was read again without ST2 between: it is held until ST2 is read",
            ),
            Complaint::MagI2cDisabled => f.write_str(
                "I2CDIS silenced the magnetometer on its bus, until it is reset",
            ),
        }
    }
}

/// Every complaint with the time it was first made.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Complaints(Vec<(Ticks, Complaint)>);

impl Complaints {
    /// Notes a complaint, unless it is there already: a mistake in a loop is one mistake.
    pub fn note(&mut self, at: Ticks, complaint: Complaint) {
        if !self.0.iter().any(|(_, known)| *known == complaint) {
            self.0.push((at, complaint));
        }
    }

    /// The complaints so far, in the order of time.
    pub fn list(&self) -> &[(Ticks, Complaint)] {
        &self.0
    }

    /// Takes the complaints so far; the same mistake made again is noted again.
    pub fn take(&mut self) -> Vec<(Ticks, Complaint)> {
        std::mem::take(&mut self.0)
    }
}
