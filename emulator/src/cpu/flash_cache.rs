//! The flash controller's cache at its pessimistic end: how long the core waits for program flash.
//!
//! The flash is read in 64-bit words at its own clock. A read that misses takes the ratio of core to flash clock at
//! best, and that ratio minus one more when the clocks have to be aligned (K20 manual 27.5.3); here every miss takes
//! the longest time, and the buffer that reads ahead (27.5.4) never helps. The cache has four ways of eight sets;
//! the least recently used way is replaced.

use super::FLASH_SIZE;

const WAYS: usize = 4;
const SETS: usize = 8;
/// Bytes of a line, as a shift.
const LINE: u32 = 3;
/// No line of the flash.
const EMPTY: u32 = u32::MAX;

/// Tags of the lines at hand, the most recently used first.
#[derive(Debug, Clone)]
pub struct FlashCache {
    sets: [[u32; WAYS]; SETS],
    /// The line that instructions come from.
    fetching: u32,
}

impl Default for FlashCache {
    fn default() -> FlashCache {
        FlashCache {
            sets: [[EMPTY; WAYS]; SETS],
            fetching: EMPTY,
        }
    }
}

impl FlashCache {
    /// Cycles that the core waits for the instruction of `length` bytes at `pc`.
    pub fn fetch(&mut self, pc: u32, length: u8, ratio: u32) -> u64 {
        if pc >= FLASH_SIZE {
            return 0;
        }
        let last = (pc + u32::from(length) - 1) >> LINE;
        let mut waits = 0;
        for line in pc >> LINE..=last {
            if line != self.fetching {
                self.fetching = line;
                waits += self.look_up(line, ratio);
            }
        }
        waits
    }

    /// Cycles that the core waits for data at `address`.
    pub fn load(&mut self, address: u32, ratio: u32) -> u64 {
        if address < FLASH_SIZE {
            self.look_up(address >> LINE, ratio)
        } else {
            0
        }
    }

    fn look_up(&mut self, line: u32, ratio: u32) -> u64 {
        let set = &mut self.sets[line as usize % SETS];
        let found = set.iter().position(|&tag| tag == line);
        set[..=found.unwrap_or(WAYS - 1)].rotate_right(1);
        set[0] = line;
        match found {
            Some(_) => 0,
            None => u64::from(2 * ratio - 2),
        }
    }
}
