//! How the board is put together.

use crate::cpu::Pace;
use crate::motion::Motion;
use crate::mpu9250::Part;
pub use crate::peripherals::ftfl::Eeprom;
use crate::witness::Trap;

/// What is on the board, and how strictly it is judged.
pub struct Setup {
    /// What the sensor experiences, from power-on.
    pub motion: Box<dyn Motion>,
    /// The individual sensor: what it is, and its errors.
    pub part: Part,
    /// What an earlier board has left in the EEPROM.
    pub eeprom: Eeprom,
    /// Traps that do not stop the run: the board goes on as silicon would.
    pub allowed: Vec<Trap>,
    /// By which end of the band of cycle counts time passes.
    pub pace: Pace,
    /// Whether polling loops in which nothing changes are passed over. No result depends on it, only the speed.
    pub skip_polling: bool,
    /// A function whose calls are timed, by the end of its path; empty for none.
    pub timed_function: String,
}

impl Setup {
    /// A board with a perfect MPU-9250 moved by `motion`; every trap stops it.
    pub fn new(motion: Box<dyn Motion>) -> Setup {
        Setup {
            motion,
            part: Part::perfect(),
            eeprom: Eeprom::default(),
            allowed: Vec::new(),
            pace: Pace::default(),
            skip_polling: true,
            timed_function: String::new(),
        }
    }

    /// The same board with what an earlier one has left in its EEPROM.
    pub fn with_eeprom(mut self, eeprom: Eeprom) -> Setup {
        self.eeprom = eeprom;
        self
    }

    /// The same board, which goes on as silicon would after stepping into one of these traps.
    pub fn allowing(mut self, traps: &[Trap]) -> Setup {
        self.allowed.extend(traps);
        self
    }
}
