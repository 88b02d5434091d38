//! The FIFO: 512 bytes, and what happens when they do not suffice (product specification 4.17; register map 4.36 and
//! 4.37).

use std::collections::VecDeque;

/// Bytes it holds.
pub const CAPACITY: usize = 512;

/// The bytes that were stored and not read.
#[derive(Debug, Clone, Default)]
pub struct Fifo {
    bytes: VecDeque<u8>,
    /// What an empty FIFO gives: the byte read last.
    last: u8,
    /// FIFO_COUNT as it was when its high byte was read.
    count: u16,
}

impl Fifo {
    /// Stores a byte. In a full FIFO the oldest gives way; or with `keep` (FIFO_MODE) the new byte is lost. Returns
    /// `true` if one was lost.
    pub fn push(&mut self, byte: u8, keep: bool) -> bool {
        let full = self.bytes.len() >= CAPACITY;
        if full && keep {
            return true;
        }
        if full {
            self.bytes.pop_front();
        }
        self.bytes.push_back(byte);
        full
    }

    /// Takes the oldest byte; `Err` has the last one again.
    pub fn pop(&mut self) -> Result<u8, u8> {
        let byte = self.bytes.pop_front().ok_or(self.last)?;
        self.last = byte;
        Ok(byte)
    }

    /// The byte read last.
    pub fn last(&self) -> u8 {
        self.last
    }

    /// FIFO_COUNTH; holds FIFO_COUNTL.
    pub fn count_high(&mut self) -> u8 {
        self.count = self.bytes.len() as u16;
        (self.count >> 8) as u8
    }

    /// FIFO_COUNTL, as of the last [`count_high`](Fifo::count_high).
    pub fn count_low(&self) -> u8 {
        self.count as u8
    }

    /// Empties it.
    pub fn clear(&mut self) {
        self.bytes.clear();
    }
}
