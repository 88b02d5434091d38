//! Interrupt status and the INT pin (register map, sections 4.19 to 4.21).

use super::registers::{INT_ENABLE, INT_PIN_CFG, Registers};
use crate::time::{MICROSECOND, Ticks};

/// A new sample.
pub const RAW_DATA_RDY: u8 = 1 << 0;
/// The FIFO lost a byte.
pub const FIFO_OFLOW: u8 = 1 << 4;
/// Wake on motion.
pub const WOM: u8 = 1 << 6;

const ACTIVE_LOW: u8 = 1 << 7;
const LATCH_INT_EN: u8 = 1 << 5;
const INT_ANYRD_2CLEAR: u8 = 1 << 4;

/// Width of a pulse without LATCH_INT_EN (product specification, table 4).
const PULSE: Ticks = 50 * MICROSECOND;

/// What has happened and was not yet read.
#[derive(Debug, Clone, Default)]
pub struct Interrupts {
    status: u8,
    /// Start of the last pulse.
    pulse: Option<Ticks>,
}

impl Interrupts {
    /// Something happens. Status bits show it whether or not it is enabled; the pin only if it is.
    pub fn raise(&mut self, bits: u8, registers: &Registers, at: Ticks) {
        self.status |= bits;
        if bits & registers[INT_ENABLE] != 0 {
            self.pulse = Some(at);
        }
    }

    /// Reads and clears INT_STATUS.
    pub fn read_status(&mut self) -> u8 {
        std::mem::take(&mut self.status)
    }

    /// Any other register is read, which clears the status if INT_ANYRD_2CLEAR is set.
    pub fn any_read(&mut self, registers: &Registers) {
        if registers.has(INT_PIN_CFG, INT_ANYRD_2CLEAR) {
            self.status = 0;
        }
    }

    /// Level of the INT pin: `true` is high.
    pub fn pin(&self, registers: &Registers, now: Ticks) -> bool {
        let active = if registers.has(INT_PIN_CFG, LATCH_INT_EN) {
            self.status & registers[INT_ENABLE] != 0
        } else {
            self.pulse
                .is_some_and(|start| (start..start + PULSE).contains(&now))
        };
        active != registers.has(INT_PIN_CFG, ACTIVE_LOW)
    }
}
