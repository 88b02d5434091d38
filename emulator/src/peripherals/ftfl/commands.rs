//! The flash commands: what each checks, does and takes (K20 manual, chapter "Flash Memory Module (FTFL)", command
//! descriptions with their error tables).
//!
//! Times are typical ones of the order of the data sheet's flash timing tables; no program may rely on them.

use std::ops::Range;

use super::memory::{FLEXNVM_SIZE, FLEXRAM_SIZE};
use super::{FCNFG, FDPROT, FPROT, FSEC, FlashController, RAMRDY};
use crate::cpu::FLASH_SIZE;
use crate::time::{MICROSECOND, MILLISECOND, Ticks};
use crate::witness::{Trap, Witness};

/// Bit 23 of a command's address selects FlexNVM.
const FLEXNVM: u32 = 0x80_0000;
/// Erased in one piece: 2 KiB of program flash, 1 KiB of FlexNVM.
const PROGRAM_SECTOR: usize = 2048;
const FLEXNVM_SECTOR: usize = 1024;
/// Section commands count in phrases.
const PHRASE: usize = 8;
/// Where the flash configuration field's security byte stands.
const SECURITY_BYTE: usize = 0x40C;

/// What a command changes when it is done.
#[derive(Debug, Clone)]
pub(super) enum Effect {
    Nothing,
    /// FCCOB4 to 7, as they stand in the registers.
    Return([u8; 4]),
    VerifyFailed,
    FlexRam {
        eeprom: bool,
    },
    /// These bytes of FlexRAM are in the EEPROM.
    EepromWritten(Range<usize>),
    /// What the reset sequence does where there is EEPROM.
    EepromLoaded,
    /// FlexNVM is partitioned, by these codes.
    Partitioned([u8; 2]),
    Unsecured,
    Erased,
}

/// A command that was accepted.
#[derive(Debug)]
pub(super) struct Command {
    pub takes: Ticks,
    pub effect: Effect,
    pub hides_flash: bool,
}

/// Why a command is refused.
#[derive(Debug)]
pub(super) enum Failure {
    /// ACCERR.
    Access(&'static str),
    /// FPVIOL, at this address.
    Protected(u32),
}

/// A place that commands work on.
#[derive(Debug, Clone, Copy)]
struct Place {
    address: u32,
    flexnvm: bool,
    offset: usize,
}

/// How long the reset sequence takes to gather the EEPROM's records in FlexRAM. Nothing public says; long enough that
/// a program which does not wait is found out.
pub(super) const EEPROM_LOADING: Ticks = 5 * MILLISECOND;

/// How long a record of emulated EEPROM takes to write (data sheet, 32 KB EEPROM backup).
pub(super) fn eeprom_write_time(width: u8) -> Ticks {
    if width == 4 {
        630 * MICROSECOND
    } else {
        385 * MICROSECOND
    }
}

fn verified(good: bool) -> Effect {
    if good {
        Effect::Nothing
    } else {
        Effect::VerifyFailed
    }
}

impl FlashController {
    /// Checks the command in FCCOB and carries it out; its effects show when its time has passed.
    pub(super) fn command(&mut self, witness: &mut Witness) -> Result<Command, Failure> {
        let command = |takes, effect, hides_flash| {
            Ok(Command {
                takes,
                effect,
                hides_flash,
            })
        };
        match self.object(0) {
            0x00 => {
                let place = self.place(4)?;
                self.margin(4, 0..=2)?;
                let erased = self.block(place).iter().all(|&byte| byte == 0xFF);
                command(1700 * MICROSECOND, verified(erased), !place.flexnvm)
            }
            0x01 => {
                let place = self.place(PHRASE)?;
                self.margin(6, 0..=2)?;
                let section = self.section(place)?;
                let erased = self.block(place)[section].iter().all(|&byte| byte == 0xFF);
                command(60 * MICROSECOND, verified(erased), !place.flexnvm)
            }
            0x02 => {
                let place = self.place(4)?;
                self.margin(4, 1..=2)?;
                let expected = [11, 10, 9, 8].map(|n| self.object(n));
                let same = self.block(place)[place.offset..place.offset + 4] == expected;
                command(45 * MICROSECOND, verified(same), !place.flexnvm)
            }
            0x03 => self.read_resource(),
            0x06 => {
                let place = self.unprotected(4)?;
                let data = [7, 6, 5, 4].map(|n| self.object(n));
                self.program(place, &data, witness);
                command(65 * MICROSECOND, Effect::Nothing, !place.flexnvm)
            }
            0x08 => {
                let place = self.place(4)?;
                self.block_unprotected(place)?;
                self.erase(place, 0..self.block(place).len(), witness);
                command(122 * MILLISECOND, Effect::Nothing, !place.flexnvm)
            }
            0x09 => {
                let place = self.unprotected(PHRASE)?;
                let size = if place.flexnvm {
                    FLEXNVM_SECTOR
                } else {
                    PROGRAM_SECTOR
                };
                let start = place.offset / size * size;
                self.erase(place, start..start + size, witness);
                command(14 * MILLISECOND, Effect::Nothing, !place.flexnvm)
            }
            0x0B => {
                let place = self.unprotected(PHRASE)?;
                if self.registers[FCNFG] & RAMRDY == 0 {
                    return Err(Failure::Access(
                        "FlexRAM is not available as the section program buffer",
                    ));
                }
                let section = self.section(place)?;
                // The lower half of FlexRAM is the buffer.
                if section.len() > FLEXRAM_SIZE / 2 {
                    return Err(Failure::Access(
                        "the section is larger than the section program buffer",
                    ));
                }
                let data = self.memory.flexram()[..section.len()].to_vec();
                let phrases = (section.len() / PHRASE) as Ticks;
                self.program(place, &data, witness);
                command(phrases * 75 * MICROSECOND, Effect::Nothing, !place.flexnvm)
            }
            0x40 => {
                self.margin(1, 0..=2)?;
                let memory = &self.memory;
                let erased = memory
                    .program
                    .iter()
                    .chain(&memory.flexnvm)
                    .all(|&byte| byte == 0xFF);
                command(1800 * MICROSECOND, verified(erased), true)
            }
            // Short enough for PJRC's core to wait in flash: its loop stands in the controller's cache by then.
            0x41 => {
                let record = self.record()?;
                // As Program Once took them: FCCOB4 holds the record's first byte.
                let [b0, b1, b2, b3] = self.memory.once[record];
                command(25 * MICROSECOND, Effect::Return([b3, b2, b1, b0]), false)
            }
            0x43 => {
                let record = self.record()?;
                if self.memory.once[record] != [0xFF; 4] {
                    return Err(Failure::Access("the record was programmed before"));
                }
                self.memory.once[record] = [4, 5, 6, 7].map(|n| self.object(n));
                command(65 * MICROSECOND, Effect::Nothing, true)
            }
            0x44 => {
                if self.registers[FPROT..FPROT + 4] != [0xFF; 4] || self.registers[FDPROT] != 0xFF {
                    return Err(Failure::Protected(0));
                }
                self.memory.erase_all();
                witness.saw(Trap::FlashSecured, "Erase All Blocks leaves 0x40C at 0xFF, which secures the chip at the next reset");
                command(175 * MILLISECOND, Effect::Erased, true)
            }
            0x45 => self.verify_key(),
            0x80 => self.program_partition(),
            0x81 => {
                let eeprom = match self.object(1) {
                    0x00 => true,
                    0xFF => false,
                    _ => {
                        return Err(Failure::Access(
                            "the FlexRAM function is neither 0x00 nor 0xFF",
                        ));
                    }
                };
                if eeprom && self.memory.eeprom_size() == 0 {
                    return Err(Failure::Access("FlexNVM is not partitioned for EEPROM"));
                }
                if eeprom {
                    self.memory.reload_flexram();
                }
                self.registers[FCNFG] &= !3;
                command(800 * MICROSECOND, Effect::FlexRam { eeprom }, false)
            }
            _ => Err(Failure::Access("there is no such command")),
        }
    }

    /// The address in FCCOB1 to 3, if it is one and aligned.
    fn place(&self, alignment: usize) -> Result<Place, Failure> {
        let address = u32::from_be_bytes([0, self.object(1), self.object(2), self.object(3)]);
        let (flexnvm, offset) = (address & FLEXNVM != 0, (address & !FLEXNVM) as usize);
        let size = if flexnvm {
            self.memory.data_flash_size()
        } else {
            FLASH_SIZE as usize
        };
        if !offset.is_multiple_of(alignment) {
            return Err(Failure::Access("the address is not aligned"));
        }
        if offset >= size {
            return Err(Failure::Access("the address is not in flash"));
        }
        Ok(Place {
            address,
            flexnvm,
            offset,
        })
    }

    /// The same, if it may be changed: each FPROT bit guards a 32nd of program flash, each FDPROT bit an eighth of data
    /// flash.
    fn unprotected(&self, alignment: usize) -> Result<Place, Failure> {
        let place = self.place(alignment)?;
        let open = if place.flexnvm {
            self.registers[FDPROT] >> (place.offset * 8 / self.memory.data_flash_size()) & 1 != 0
        } else {
            // FPROT3 at the lowest address guards the lowest regions.
            let region = place.offset / (FLASH_SIZE as usize / 32);
            self.registers[FPROT + region / 8] >> (region % 8) & 1 != 0
        };
        if open {
            Ok(place)
        } else {
            Err(Failure::Protected(place.address))
        }
    }

    fn block_unprotected(&self, place: Place) -> Result<(), Failure> {
        let open = if place.flexnvm {
            if self.memory.data_flash_size() < FLEXNVM_SIZE {
                return Err(Failure::Access("FlexNVM is partitioned for EEPROM"));
            }
            self.registers[FDPROT] == 0xFF
        } else {
            self.registers[FPROT..FPROT + 4] == [0xFF; 4]
        };
        if open {
            Ok(())
        } else {
            Err(Failure::Protected(place.address))
        }
    }

    fn margin(&self, n: usize, allowed: std::ops::RangeInclusive<u8>) -> Result<(), Failure> {
        if allowed.contains(&self.object(n)) {
            Ok(())
        } else {
            Err(Failure::Access("there is no such read margin"))
        }
    }

    fn record(&self) -> Result<usize, Failure> {
        let record = usize::from(self.object(1));
        if record < self.memory.once.len() {
            Ok(record)
        } else {
            Err(Failure::Access("the record index is above 0x0F"))
        }
    }

    fn block(&self, place: Place) -> &[u8] {
        if place.flexnvm {
            &self.memory.flexnvm
        } else {
            &self.memory.program
        }
    }

    /// The section of FCCOB4:5 phrases from `place` on; it must not cross a sector.
    fn section(&self, place: Place) -> Result<Range<usize>, Failure> {
        let length = usize::from(u16::from_be_bytes([self.object(4), self.object(5)])) * PHRASE;
        let end = place.offset + length;
        let programs = self.object(0) == 0x0B;
        let sector = if place.flexnvm {
            FLEXNVM_SECTOR
        } else {
            PROGRAM_SECTOR
        };
        if length == 0 {
            Err(Failure::Access("the section has no length"))
        } else if end > self.block(place).len()
            || programs && (end - 1) / sector != place.offset / sector
        {
            Err(Failure::Access(
                "the section crosses a boundary of the flash",
            ))
        } else {
            Ok(place.offset..end)
        }
    }

    fn program(&mut self, place: Place, data: &[u8], witness: &mut Witness) {
        let range = place.offset..place.offset + data.len();
        let memory = if place.flexnvm {
            &mut self.memory.flexnvm
        } else {
            &mut self.memory.program
        };
        for (word, old) in data.chunks(4).zip(memory[range.clone()].chunks_mut(4)) {
            if old.iter().any(|&byte| byte != 0xFF) {
                let what = format!(
                    "the longword programmed at {:#08x} is {old:02x?}, not erased",
                    place.address
                );
                witness.saw(Trap::FlashNotErased, what);
            }
            // Programming turns ones into zeros only.
            old.iter_mut().zip(word).for_each(|(old, new)| *old &= new);
        }
        self.look_at_security(place, range, witness);
    }

    fn erase(&mut self, place: Place, range: Range<usize>, witness: &mut Witness) {
        if place.flexnvm {
            self.memory.flexnvm[range].fill(0xFF);
        } else {
            self.memory.program[range.clone()].fill(0xFF);
            self.look_at_security(place, range, witness);
        }
    }

    /// A chip whose security byte is not 0b10 in its lowest bits cannot be opened after the next reset.
    fn look_at_security(&self, place: Place, range: Range<usize>, witness: &mut Witness) {
        let byte = self.memory.program[SECURITY_BYTE];
        if !place.flexnvm && range.contains(&SECURITY_BYTE) && byte & 3 != 2 {
            let what = format!(
                "flash command {:#04x} leaves {byte:#04x} at 0x40C",
                self.object(0)
            );
            witness.saw(Trap::FlashSecured, what);
        }
    }

    /// Read Resource: code 0 is the information row with the partition codes, 1 the version.
    fn read_resource(&self) -> Result<Command, Failure> {
        let address = u32::from_be_bytes([0, self.object(1), self.object(2), self.object(3)]);
        if !address.is_multiple_of(4) {
            return Err(Failure::Access("the address is not aligned"));
        }
        // FCCOB7 is the byte at the lowest address, as in Program Longword.
        let once = |n: usize| {
            let [b0, b1, b2, b3] = self.memory.once[n];
            [b3, b2, b1, b0]
        };
        let bytes = match (self.object(8), address) {
            // The write-once field stands at 0xC0 of the program flash's information row.
            (0, 0x00..0xC0) => [0xFF; 4],
            (0, 0xC0..0x100) => once((address as usize - 0xC0) / 4),
            // EEPROM data set size at 0xFD and partition code at 0xFC of FlexNVM's.
            (0, 0x80_00FC) => [
                self.memory.partition[1],
                self.memory.partition[0],
                0xFF,
                0xFF,
            ],
            (0, 0x80_0000..0x80_0100) => [0xFF; 4],
            (1, 0x00..0x08) => [0; 4],
            _ => return Err(Failure::Access("there is no such resource")),
        };
        Ok(Command {
            takes: 30 * MICROSECOND,
            effect: Effect::Return(bytes),
            hides_flash: address & FLEXNVM == 0,
        })
    }

    /// Verify Backdoor Access Key: possible only with KEYEN = 0b10, once after each reset if it fails.
    fn verify_key(&mut self) -> Result<Command, Failure> {
        let key: Vec<u8> = [7, 6, 5, 4, 11, 10, 9, 8].map(|n| self.object(n)).to_vec();
        if self.registers[FSEC] >> 6 != 2 || self.key_refused {
            return Err(Failure::Access("backdoor key access is not enabled"));
        }
        if key != self.memory.program[0x400..0x408] {
            self.key_refused = true;
            return Err(Failure::Access("the backdoor key does not match"));
        }
        Ok(Command {
            takes: 30 * MICROSECOND,
            effect: Effect::Unsecured,
            hides_flash: true,
        })
    }

    /// Program Partition: splits FlexNVM into data flash and EEPROM backup, once until everything is erased.
    fn program_partition(&mut self) -> Result<Command, Failure> {
        let partition = [self.object(4), self.object(5)];
        let (size, code) = (partition[0] & 0xF, partition[1] & 0xF);
        if self.memory.partition != [0xFF; 2] {
            return Err(Failure::Access(
                "FlexNVM is partitioned already; erase all blocks first",
            ));
        }
        let with_eeprom = match code {
            0x0 | 0xB | 0xF => false,
            0x1..=0x3 | 0x8..=0xA => true,
            _ => return Err(Failure::Access("there is no such FlexNVM partition code")),
        };
        if !matches!(size, 3..=9 | 0xF) || with_eeprom != (size != 0xF) {
            return Err(Failure::Access(
                "the EEPROM data set size does not fit the partition code",
            ));
        }
        self.registers[FCNFG] &= !3;
        Ok(Command {
            takes: 70 * MILLISECOND,
            effect: Effect::Partitioned(partition),
            hides_flash: true,
        })
    }
}
