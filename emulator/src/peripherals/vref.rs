//! Voltage reference (K20 manual, chapter "Voltage Reference (VREFV1)"): 1.2 V once it has started.

use crate::time::{MILLISECOND, NEVER, Ticks};

const TRM: u32 = 0;
const SC: u32 = 1;

const VREFEN: u8 = 1 << 7;
const VREFST: u8 = 1 << 2;

/// Start-up time (data sheet: 35 ms with the buffer at most).
const START_UP: Ticks = 35 * MILLISECOND;
/// The factory's voltage (V), and a trim step (data sheet: 0.5 mV).
const VOLTS: f64 = 1.195;
const STEP: f64 = 0.0005;

/// The reference.
#[derive(Debug, Clone)]
pub struct VoltageReference {
    trim: u8,
    control: u8,
    stable_at: Ticks,
}

impl VoltageReference {
    /// The state after reset: off.
    pub fn new() -> VoltageReference {
        VoltageReference {
            trim: 0x20,
            control: 0,
            stable_at: NEVER,
        }
    }

    /// The voltage it puts out; 0 while it is off.
    pub fn volts(&self, now: Ticks) -> f64 {
        if now < self.stable_at {
            return 0.0;
        }
        // Trim 0x20 is the middle of six bits.
        VOLTS + STEP * (f64::from(self.trim & 0x3F) - 32.0)
    }

    /// Reads an 8-bit register.
    pub fn read(&self, offset: u32, now: Ticks) -> u32 {
        match offset {
            TRM => u32::from(self.trim),
            SC => u32::from(self.control | if now >= self.stable_at { VREFST } else { 0 }),
            _ => 0,
        }
    }

    /// Writes an 8-bit register.
    pub fn write(&mut self, offset: u32, value: u8, now: Ticks) {
        match offset {
            TRM => self.trim = value,
            SC => {
                if value & VREFEN == 0 {
                    self.stable_at = NEVER;
                } else if self.control & VREFEN == 0 {
                    self.stable_at = now + START_UP;
                }
                self.control = value & !VREFST;
            }
            _ => {}
        }
    }
}

impl Default for VoltageReference {
    fn default() -> VoltageReference {
        VoltageReference::new()
    }
}
