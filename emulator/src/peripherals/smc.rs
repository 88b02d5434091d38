//! System mode controller (K20 manual, chapter "System Mode Controller (SMC)"): the run modes. What sleeps in a stop
//! mode is the processor alone.

const PMPROT: u32 = 0;
const PMCTRL: u32 = 1;
const VLLSCTRL: u32 = 2;
const PMSTAT: u32 = 3;

/// PMSTAT.
const RUN: u8 = 1 << 0;
const VLPR: u8 = 1 << 2;
/// PMPROT: very-low-power modes are allowed.
const AVLP: u8 = 1 << 5;

/// The controller.
#[derive(Debug, Clone)]
pub struct ModeController {
    /// Allowed modes, once they were written; only the first write after a reset counts.
    allowed: Option<u8>,
    control: u8,
    vlls: u8,
    status: u8,
}

impl ModeController {
    /// The state after reset: normal run mode.
    pub fn new() -> ModeController {
        ModeController {
            allowed: None,
            control: 0,
            vlls: 0x03,
            status: RUN,
        }
    }

    /// Reads an 8-bit register.
    pub fn read(&self, offset: u32) -> u32 {
        u32::from(match offset {
            PMPROT => self.allowed.unwrap_or(0),
            PMCTRL => self.control,
            VLLSCTRL => self.vlls,
            PMSTAT => self.status,
            _ => 0,
        })
    }

    /// Writes an 8-bit register.
    pub fn write(&mut self, offset: u32, value: u8) {
        match offset {
            PMPROT => {
                self.allowed.get_or_insert(value & 0x2A);
            }
            PMCTRL => {
                let allowed = self.allowed.unwrap_or(0) & AVLP != 0;
                let (run, mode) = match value >> 5 & 3 {
                    2 if allowed => (2, VLPR),
                    _ => (0, RUN),
                };
                self.control = value & 0x87 | run << 5;
                self.status = mode;
            }
            VLLSCTRL => self.vlls = value,
            _ => {}
        }
    }
}

impl Default for ModeController {
    fn default() -> ModeController {
        ModeController::new()
    }
}
