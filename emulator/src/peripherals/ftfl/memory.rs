//! What the flash module remembers without power: program flash, FlexNVM, the write-once field and the partition.

use std::ops::Range;

use super::eeprom::Eeprom;

/// Where FlexNVM used as data flash begins.
pub const FLEXNVM_BASE: u32 = 0x1000_0000;
/// Where FlexRAM begins.
pub const FLEXRAM_BASE: u32 = 0x1400_0000;

/// Bytes of FlexNVM and of FlexRAM.
pub(super) const FLEXNVM_SIZE: usize = 32 * 1024;
pub(super) const FLEXRAM_SIZE: usize = 2 * 1024;

/// The record in which PJRC's factory programming leaves a board's serial number.
const SERIAL_RECORD: usize = 0x0F;
/// Any number will do; a real board's is programmed at PJRC.
const SERIAL_NUMBER: u32 = 490_000;

/// The memories of the flash module; a reset leaves all but FlexRAM as they are.
#[derive(Debug, Clone)]
pub struct Memory {
    /// Program flash, from address 0.
    pub program: Vec<u8>,
    pub(super) flexnvm: Vec<u8>,
    pub(super) once: [[u8; 4]; 16],
    /// EEPROM data set size code and FlexNVM partition code; all ones where never partitioned.
    pub(super) partition: [u8; 2],
    eeprom: Vec<u8>,
    flexram: Vec<u8>,
}

impl Memory {
    /// The memories of a board on which only `program` was ever written.
    pub fn new(program: &[u8]) -> Memory {
        let mut once = [[0xFF; 4]; 16];
        once[SERIAL_RECORD] = SERIAL_NUMBER.to_be_bytes();
        Memory {
            program: program.to_vec(),
            flexnvm: vec![0xFF; FLEXNVM_SIZE],
            once,
            partition: [0xFF; 2],
            eeprom: vec![0xFF; FLEXRAM_SIZE],
            // Not zero, so that a program which relies on it is found out.
            flexram: (0..FLEXRAM_SIZE)
                .map(|n| (n as u8).wrapping_mul(167) ^ 0xA5)
                .collect(),
        }
    }

    /// Bytes of emulated EEPROM, from its data set size code; 0 while the chip is not partitioned for it.
    pub fn eeprom_size(&self) -> usize {
        match self.partition[0] & 0xF {
            code @ 3..=9 => 2048 >> (code - 3),
            _ => 0,
        }
    }

    /// The same with this in its EEPROM.
    pub fn with_eeprom(mut self, eeprom: &Eeprom) -> Memory {
        self.partition = eeprom.partition();
        self.with_eeprom_contents(eeprom)
    }

    /// The same, partitioned as it is, with this in its EEPROM.
    pub(super) fn with_eeprom_contents(mut self, eeprom: &Eeprom) -> Memory {
        self.eeprom[..eeprom.bytes().len()].copy_from_slice(eeprom.bytes());
        self
    }

    /// The EEPROM's contents.
    pub(super) fn eeprom(&self) -> &[u8] {
        &self.eeprom[..self.eeprom_size()]
    }

    /// The partition is written: FlexNVM is erased, and FlexRAM shows an EEPROM that was never written.
    pub(super) fn split(&mut self, partition: [u8; 2]) {
        self.partition = partition;
        self.flexnvm.fill(0xFF);
        self.reload_flexram();
    }

    /// Bytes of FlexNVM left as data flash, from its partition code.
    pub(super) fn data_flash_size(&self) -> usize {
        match self.partition[1] & 0xF {
            0x3 => 0,
            0x2 => 16 * 1024,
            0x1 => 24 * 1024,
            0x8 => 0,
            0x9 => 8 * 1024,
            0xA => 16 * 1024,
            0xB => 32 * 1024,
            _ => FLEXNVM_SIZE,
        }
    }

    /// What SIM_FCFG1 shows of the partition: EESIZE in bits 19 to 16 and DEPART in bits 11 to 8.
    pub fn configuration(&self) -> u32 {
        u32::from(self.partition[0] & 0xF) << 16 | u32::from(self.partition[1] & 0xF) << 8
    }

    pub(super) fn reload_flexram(&mut self) {
        let size = self.eeprom_size();
        self.flexram[..size].copy_from_slice(&self.eeprom[..size]);
    }

    /// These bytes of FlexRAM are in the EEPROM now.
    pub(super) fn keep_eeprom(&mut self, range: Range<usize>) {
        self.eeprom[range.clone()].copy_from_slice(&self.flexram[range]);
    }

    /// Everything erased, as by Erase All Blocks; what was written once stays.
    pub(super) fn erase_all(&mut self) {
        self.program.fill(0xFF);
        self.flexnvm.fill(0xFF);
        self.eeprom.fill(0xFF);
        self.partition = [0xFF; 2];
    }

    pub(super) fn flexram(&self) -> &[u8] {
        &self.flexram
    }

    pub(super) fn read_flex(&self, address: u32, width: u8) -> Option<u32> {
        let (memory, size, base) = if address >= FLEXRAM_BASE {
            (&self.flexram, FLEXRAM_SIZE, FLEXRAM_BASE)
        } else {
            (&self.flexnvm, self.data_flash_size(), FLEXNVM_BASE)
        };
        let at = (address - base) as usize;
        let bytes = memory[..size].get(at..at + usize::from(width))?;
        Some(
            bytes
                .iter()
                .rev()
                .fold(0, |word, &byte| word << 8 | u32::from(byte)),
        )
    }

    pub(super) fn write_flexram(&mut self, address: u32, width: u8, value: u32) -> bool {
        let at = (address - FLEXRAM_BASE) as usize;
        let bytes = value.to_le_bytes();
        let Some(place) = self.flexram.get_mut(at..at + usize::from(width)) else {
            return false;
        };
        place.copy_from_slice(&bytes[..usize::from(width)]);
        true
    }
}
