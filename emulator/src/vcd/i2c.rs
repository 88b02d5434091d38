//! SCL and SDA, from what crossed the bus.

use crate::journal::{Happening, I2cByte};
use crate::time::Ticks;

/// Both wires from a moment on.
type Levels = (Ticks, bool, bool);

/// Follows the wires.
#[derive(Debug, Clone)]
pub(super) struct Lines {
    /// Between a START and its STOP, where SCL rests low.
    busy: bool,
    /// SDA as it was left.
    sda: bool,
    /// Levels by somebody else than I2C0.
    others: (bool, bool),
}

impl Default for Lines {
    fn default() -> Lines {
        Lines {
            busy: false,
            sda: true,
            others: (true, true),
        }
    }
}

impl Lines {
    /// The levels that `happening`, told at `end`, stands for.
    pub fn follow(&mut self, end: Ticks, happening: &Happening) -> Vec<Levels> {
        let mut levels = Vec::new();
        match *happening {
            Happening::I2cByte {
                kind,
                byte,
                acknowledged,
                bit,
            } => {
                let begin = end.saturating_sub(9 * bit);
                if kind == I2cByte::Address {
                    self.start(begin.saturating_sub(bit), bit, &mut levels);
                }
                self.bits(begin, bit, byte, acknowledged, &mut levels);
            }
            Happening::I2cStop { bit } => {
                let begin = end.saturating_sub(bit);
                levels.push((begin, false, false));
                levels.push((begin + bit / 2, true, false));
                levels.push((end, true, true));
                self.busy = false;
                self.sda = true;
            }
            Happening::Wires { scl, sda } if (scl, sda) != self.others => {
                self.others = (scl, sda);
                self.busy = false;
                self.sda = sda;
                levels.push((end, scl, sda));
            }
            Happening::Reset if self.busy => {
                self.busy = false;
                self.sda = true;
                levels.push((end, true, true));
            }
            _ => {}
        }
        levels
    }

    /// SDA falls while SCL is high; a repeated START lets both rise before.
    fn start(&mut self, begin: Ticks, bit: Ticks, levels: &mut Vec<Levels>) {
        if self.busy {
            levels.push((begin, false, true));
            levels.push((begin + bit / 4, true, true));
        }
        levels.push((begin + bit / 2, true, false));
        levels.push((begin + bit, false, false));
        self.busy = true;
        self.sda = false;
    }

    /// Eight bits, the highest first, and the acknowledgement, which is low.
    fn bits(&mut self, begin: Ticks, bit: Ticks, byte: u8, ack: bool, levels: &mut Vec<Levels>) {
        let word = u16::from(byte) << 1 | u16::from(!ack);
        for position in 0..9_u32 {
            let from = begin + Ticks::from(position) * bit;
            levels.push((from, false, self.sda));
            self.sda = word >> (8 - position) & 1 != 0;
            levels.push((from + bit / 4, false, self.sda));
            levels.push((from + bit / 2, true, self.sda));
        }
        levels.push((begin + 9 * bit, false, self.sda));
    }
}
