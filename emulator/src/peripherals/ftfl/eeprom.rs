//! What the emulated EEPROM holds, apart from the chip: it goes from one board to the next, as over a power cycle.

use std::error::Error;
use std::fmt;

/// EEPROM data set size code of the largest, 2 KiB (K20 manual, Program Partition); each further code halves it.
const LARGEST_CODE: u8 = 3;
const LARGEST: usize = 2048;
const SMALLEST: usize = 32;
/// Both halves alike, as Teensyduino partitions its boards.
const EVEN_SPLIT: u8 = 0x30;
/// All of FlexNVM backs the EEPROM, no data flash.
const NO_DATA_FLASH: u8 = 0x03;

/// Contents of the EEPROM; the default is that of a chip which was never partitioned, and has none.
///
/// Nothing else of FlexNVM is in it: a board made with it has no data flash.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Eeprom(Vec<u8>);

impl Eeprom {
    /// These bytes, from address 0 on; none stand for a chip that was never partitioned.
    ///
    /// # Errors
    ///
    /// [`EepromError`] unless their number is one that the chip can be partitioned for.
    pub fn new(bytes: Vec<u8>) -> Result<Eeprom, EepromError> {
        let size = bytes.len();
        let fits = size == 0 || (SMALLEST..=LARGEST).contains(&size) && size.is_power_of_two();
        if fits {
            Ok(Eeprom(bytes))
        } else {
            Err(EepromError { bytes: size })
        }
    }

    /// What is in the memory of a chip.
    pub(super) fn of(contents: Vec<u8>) -> Eeprom {
        Eeprom(contents)
    }

    /// From address 0 on; none if the chip was never partitioned.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// The same, to be damaged.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        &mut self.0
    }

    /// EEPROM data set size code and FlexNVM partition code.
    pub(super) fn partition(&self) -> [u8; 2] {
        match self.0.len() {
            0 => [0xFF; 2],
            size => {
                let halvings = (LARGEST / size).trailing_zeros() as u8;
                [EVEN_SPLIT | (LARGEST_CODE + halvings), NO_DATA_FLASH]
            }
        }
    }
}

/// No EEPROM has so many bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EepromError {
    bytes: usize,
}

impl fmt::Display for EepromError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} bytes are no EEPROM's contents: it has 2048 (Teensyduino's), 1024, 512, 256, 128, 64 or 32, or none on \
             a chip that was never partitioned",
            self.bytes
        )
    }
}

impl Error for EepromError {}
