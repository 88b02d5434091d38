//! Flash memory module (K20 manual, chapter 28), as far as a program that only reads its serial number needs it.

const FSTAT: usize = 0x00;
const FCNFG: usize = 0x01;
const FSEC: usize = 0x02;
const FOPT: usize = 0x03;
/// FCCOB3..0, FCCOB7..4, FCCOBB..8 stand byte-swapped within each word from here on (28.34.6).
const FCCOB: usize = 0x04;

const CCIF: u8 = 0x80;
const ACCERR: u8 = 0x20;
const READ_ONCE: u8 = 0x41;
/// The record in which PJRC's factory programming leaves a board's serial number.
const SERIAL_RECORD: u8 = 0x0F;

/// The flash controller's registers.
#[derive(Debug, Clone)]
pub struct FlashController {
    registers: [u8; 0x18],
    serial_number: u32,
}

impl FlashController {
    /// The state after reset, for a board with this serial number and these configuration bytes in its flash.
    pub fn new(serial_number: u32, security: u8, option: u8) -> FlashController {
        let mut registers = [0; 0x18];
        registers[FSTAT] = CCIF;
        registers[FCNFG] = 0x02; // RAMRDY: FlexRAM is plain RAM
        registers[FSEC] = security;
        registers[FOPT] = option;
        registers[0x10..].fill(0xFF); // no protection
        FlashController {
            registers,
            serial_number,
        }
    }

    /// Reads `width` bytes; the command object is commonly read as a word.
    pub fn read(&self, offset: u32, width: u8) -> u32 {
        (0..usize::from(width))
            .map(|i| {
                u32::from(
                    self.registers
                        .get(offset as usize + i)
                        .copied()
                        .unwrap_or(0),
                ) << (8 * i)
            })
            .sum()
    }

    /// Writes an 8-bit register; writing CCIF launches the command.
    pub fn write(&mut self, offset: u32, value: u8) {
        match offset as usize {
            FSTAT => {
                self.registers[FSTAT] &= !(value & 0x70);
                if value & CCIF != 0 && self.registers[FSTAT] & 0x30 == 0 {
                    self.launch();
                }
            }
            FSEC | FOPT => {}
            register if register < self.registers.len() => self.registers[register] = value,
            _ => {}
        }
    }

    fn launch(&mut self) {
        let (command, record) = (self.registers[FCCOB + 3], self.registers[FCCOB + 2]);
        if command == READ_ONCE && record == SERIAL_RECORD {
            self.registers[FCCOB + 4..FCCOB + 8].copy_from_slice(&self.serial_number.to_le_bytes());
        } else {
            self.registers[FSTAT] |= ACCERR;
        }
    }
}
