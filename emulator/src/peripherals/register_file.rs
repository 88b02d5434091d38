//! Peripherals that are present but not modelled: their registers keep what was written.

use std::collections::BTreeMap;

/// Registers by address.
#[derive(Debug, Clone, Default)]
pub struct RegisterFile {
    bytes: BTreeMap<u32, u8>,
}

impl RegisterFile {
    /// Reads `width` bytes.
    pub fn read(&self, address: u32, width: u8) -> u32 {
        (0..u32::from(width))
            .map(|i| u32::from(self.bytes.get(&(address + i)).copied().unwrap_or(0)) << (8 * i))
            .sum()
    }

    /// Writes `width` bytes.
    pub fn write(&mut self, address: u32, width: u8, value: u32) {
        for (i, byte) in (0..u32::from(width)).zip(value.to_le_bytes()) {
            self.bytes.insert(address + i, byte);
        }
    }
}
