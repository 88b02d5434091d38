//! Flash memory module (K20 manual, chapter "Flash Memory Module (FTFL)"): registers, command launch, FlexRAM and the
//! EEPROM that it emulates. What the commands do is in `commands`, the memories are in `memory`.

mod commands;

mod eeprom;

mod memory;

use crate::time::{NEVER, Ticks};
use crate::witness::{Trap, Witness};
use commands::{Effect, Failure};
pub use eeprom::{Eeprom, EepromError};
pub use memory::{FLEXNVM_BASE, FLEXRAM_BASE, Memory};

const FSTAT: usize = 0x00;
const FCNFG: usize = 0x01;
const FSEC: usize = 0x02;
const FOPT: usize = 0x03;
/// FCCOB3..0, FCCOB7..4, FCCOBB..8 stand byte-swapped within each word from here on.
const FCCOB: usize = 0x04;
const FPROT: usize = 0x10;
const FEPROT: usize = 0x16;
const FDPROT: usize = 0x17;

const CCIF: u8 = 1 << 7;
const RDCOLERR: u8 = 1 << 6;
const ACCERR: u8 = 1 << 5;
const FPVIOL: u8 = 1 << 4;
const MGSTAT0: u8 = 1 << 0;

const CCIE: u8 = 1 << 7;
const RDCOLLIE: u8 = 1 << 6;
const RAMRDY: u8 = 1 << 1;
const EEERDY: u8 = 1 << 0;

/// The command that runs.
#[derive(Debug, Clone)]
struct Running {
    until: Ticks,
    effect: Effect,
    /// Program flash cannot be read meanwhile.
    hides_flash: bool,
}

/// The flash controller with its memories.
#[derive(Debug, Clone)]
pub struct FlashController {
    registers: [u8; 0x18],
    running: Option<Running>,
    /// Key verification failed: no further attempt before a reset.
    key_refused: bool,
    /// Writes of EEPROM since power-on: each wears it.
    pub eeprom_writes: u32,
    /// A fault: what is begun never ends, until the next reset.
    pub stuck: bool,
    /// Program flash, FlexNVM and what is written once.
    pub memory: Memory,
}

impl FlashController {
    /// The state after a system reset, at `now`, of a chip with these memories.
    pub fn new(mut memory: Memory, now: Ticks) -> FlashController {
        let mut registers = [0; 0x18];
        let loading = (memory.eeprom_size() > 0).then(|| Running {
            until: now + commands::EEPROM_LOADING,
            effect: Effect::EepromLoaded,
            hides_flash: false,
        });
        if loading.is_none() {
            registers[FSTAT] = CCIF;
            registers[FCNFG] = RAMRDY;
        }
        // Loaded from the flash configuration field during reset.
        let field = |offset: usize| memory.program[0x400 + offset];
        registers[FSEC] = field(0xC);
        registers[FOPT] = field(0xD);
        for (register, offset) in (FPROT..).zip(0x8..0xC) {
            // FPROT3..0 stand at 0x10 to 0x13, the field holds them in the same order.
            registers[register] = field(offset);
        }
        registers[0x14..FEPROT].fill(0xFF);
        registers[FEPROT] = field(0xE);
        registers[FDPROT] = field(0xF);
        memory.reload_flexram();
        FlashController {
            registers,
            running: loading,
            key_refused: false,
            eeprom_writes: 0,
            stuck: false,
            memory,
        }
    }

    /// A system reset: the memories keep their contents, but for an EEPROM write that it interrupts.
    pub fn reset(&mut self, now: Ticks) {
        let memory = self.memory.clone().with_eeprom_contents(&self.eeprom());
        *self = FlashController {
            eeprom_writes: self.eeprom_writes,
            stuck: self.stuck,
            ..FlashController::new(memory, now)
        };
    }

    /// What the EEPROM would hold if power failed now.
    ///
    /// Of bytes that are being written nothing is guaranteed then; here they become neither what they were nor what
    /// they should be, so that a program which relies on either is found out.
    pub fn eeprom(&self) -> Eeprom {
        let mut contents = self.memory.eeprom().to_vec();
        if let Some(Running {
            effect: Effect::EepromWritten(range),
            ..
        }) = &self.running
        {
            let written = &self.memory.flexram()[range.clone()];
            for (byte, written) in contents[range.clone()].iter_mut().zip(written) {
                *byte = interrupted(*byte, *written);
            }
        }
        Eeprom::of(contents)
    }

    /// Whether the processor cannot read program flash now, because a command works on it.
    pub fn hides_flash(&self) -> bool {
        self.running
            .as_ref()
            .is_some_and(|running| running.hides_flash)
    }

    /// When the running command ends.
    pub fn next_event(&self) -> Ticks {
        match &self.running {
            Some(running) if !self.stuck => running.until,
            _ => NEVER,
        }
    }

    /// Ends the running command if its time has come.
    pub fn advance(&mut self, now: Ticks) {
        let stuck = self.stuck;
        let ended = |running: &mut Running| running.until <= now && !stuck;
        let Some(running) = self.running.take_if(ended) else {
            return;
        };
        match running.effect {
            Effect::Nothing => {}
            Effect::Return(bytes) => self.registers[FCCOB + 4..FCCOB + 8].copy_from_slice(&bytes),
            Effect::VerifyFailed => self.registers[FSTAT] |= MGSTAT0,
            Effect::FlexRam { eeprom } => self.use_flexram(eeprom),
            Effect::EepromWritten(range) => {
                self.memory.keep_eeprom(range);
                self.use_flexram(true);
            }
            Effect::EepromLoaded => self.use_flexram(true),
            Effect::Partitioned(codes) => {
                self.memory.split(codes);
                self.use_flexram(self.memory.eeprom_size() > 0);
            }
            Effect::Unsecured => self.registers[FSEC] = self.registers[FSEC] & !3 | 2,
            Effect::Erased => {
                self.registers[FSEC] = self.registers[FSEC] & !3 | 2;
                self.registers[FCNFG] = self.registers[FCNFG] & !EEERDY | RAMRDY;
            }
        }
        self.registers[FSTAT] |= CCIF;
    }

    /// FlexRAM is ready, as EEPROM or as RAM.
    fn use_flexram(&mut self, eeprom: bool) {
        self.registers[FCNFG] &= !(RAMRDY | EEERDY);
        self.registers[FCNFG] |= if eeprom { EEERDY } else { RAMRDY };
    }

    /// Whether "command complete" asks for its interrupt.
    pub fn complete_interrupt(&self) -> bool {
        self.registers[FCNFG] & CCIE != 0 && self.registers[FSTAT] & CCIF != 0
    }

    /// Whether "read collision" asks for its interrupt.
    pub fn collision_interrupt(&self) -> bool {
        self.registers[FCNFG] & RDCOLLIE != 0 && self.registers[FSTAT] & RDCOLERR != 0
    }

    /// FCCOB`n`, for n from 0 to 11.
    fn object(&self, n: usize) -> u8 {
        self.registers[FCCOB + (n ^ 3)]
    }

    /// Reads `width` bytes; the command object is commonly read as a word.
    pub fn read(&self, offset: u32, width: u8) -> u32 {
        let byte = |at: usize| u32::from(self.registers.get(at).copied().unwrap_or(0));
        (0..usize::from(width))
            .map(|i| byte(offset as usize + i) << (8 * i))
            .sum()
    }

    /// Writes `width` bytes; writing CCIF launches the command.
    pub fn write(&mut self, offset: u32, width: u8, value: u32, now: Ticks, witness: &mut Witness) {
        for (at, byte) in (offset as usize..).zip(&value.to_le_bytes()[..usize::from(width.min(4))])
        {
            self.write_byte(at, *byte, now, witness);
        }
    }

    fn write_byte(&mut self, at: usize, value: u8, now: Ticks, witness: &mut Witness) {
        let busy = self.running.is_some();
        match at {
            FSTAT => {
                if value & CCIF != 0 && busy {
                    witness.saw(Trap::FlashBusy, "a command is launched while another runs");
                }
                // A launch needs the error flags clear before the write (command write sequence).
                let blocked = self.registers[FSTAT] & (ACCERR | FPVIOL) != 0;
                self.registers[FSTAT] &= !(value & (RDCOLERR | ACCERR | FPVIOL));
                if value & CCIF != 0 && blocked {
                    witness.saw(
                        Trap::FlashErrorFlags,
                        "a command is launched while ACCERR or FPVIOL is set",
                    );
                } else if value & CCIF != 0 && !busy {
                    self.launch(now, witness);
                }
            }
            // Only CCIE, RDCOLLIE and the suspend request are writable; suspending is not modelled.
            FCNFG => {
                self.registers[FCNFG] = self.registers[FCNFG] & 0x3F | value & (CCIE | RDCOLLIE)
            }
            FSEC | FOPT => {}
            FCCOB..FPROT if busy => {
                witness.saw(
                    Trap::FlashBusy,
                    "FCCOB is written while a command runs; the write is ignored",
                );
            }
            // Protection can only be added in normal mode: a bit that is 0 stays 0.
            FPROT..0x14 | FEPROT | FDPROT => self.registers[at] &= value,
            at if at < FPROT => self.registers[at] = value,
            _ => {}
        }
    }

    fn launch(&mut self, now: Ticks, witness: &mut Witness) {
        self.registers[FSTAT] &= !MGSTAT0;
        match self.command(witness) {
            Ok(command) => {
                self.registers[FSTAT] &= !CCIF;
                self.running = Some(Running {
                    until: now + command.takes,
                    effect: command.effect,
                    hides_flash: command.hides_flash,
                });
            }
            Err(Failure::Access(why)) => {
                self.registers[FSTAT] |= ACCERR;
                let code = self.object(0);
                witness.saw(
                    Trap::FlashCommand,
                    format!("flash command {code:#04x} is refused: {why}"),
                );
            }
            Err(Failure::Protected(address)) => {
                self.registers[FSTAT] |= FPVIOL;
                let code = self.object(0);
                witness.saw(
                    Trap::FlashProtected,
                    format!("flash command {code:#04x} at {address:#08x}"),
                );
            }
        }
    }

    /// The processor or a bus master reads program flash while a command works on it.
    pub fn collide(&mut self, address: u32, witness: &mut Witness) {
        self.registers[FSTAT] |= RDCOLERR;
        witness.saw(
            Trap::FlashReadWhileWrite,
            format!(
                "{address:#010x} is read while flash command {:#04x} runs",
                self.object(0)
            ),
        );
    }

    /// Reads `width` bytes of FlexRAM or FlexNVM; `None` is a bus fault.
    pub fn read_flex(&mut self, address: u32, width: u8, witness: &mut Witness) -> Option<u32> {
        if address >= FLEXRAM_BASE && !self.flexram_ready() {
            let what = format!("FlexRAM is read at {address:#010x} while EEERDY is 0");
            witness.saw(Trap::EepromNotReady, what);
        }
        self.memory.read_flex(address, width)
    }

    fn flexram_ready(&self) -> bool {
        self.registers[FCNFG] & (EEERDY | RAMRDY) != 0
    }

    /// Writes `width` bytes of FlexRAM; in EEPROM mode that starts the write of a record. `false` is a bus fault.
    pub fn write_flex(
        &mut self,
        address: u32,
        width: u8,
        value: u32,
        now: Ticks,
        witness: &mut Witness,
    ) -> bool {
        if address < FLEXRAM_BASE {
            witness.saw(
                Trap::FlashStore,
                format!("a store to FlexNVM at {address:#010x}"),
            );
            return false;
        }
        if self.registers[FCNFG] & RAMRDY != 0 {
            return self.memory.write_flexram(address, width, value);
        }
        let (offset, size) = ((address - FLEXRAM_BASE) as usize, self.memory.eeprom_size());
        if !self.flexram_ready() || self.running.is_some() {
            let what = format!("FlexRAM is written at {address:#010x} while EEERDY or CCIF is 0");
            witness.saw(Trap::EepromNotReady, what);
        } else if self.registers[FSTAT] & (ACCERR | FPVIOL) != 0 {
            let what = "an EEPROM write is ignored: ACCERR or FPVIOL is set";
            witness.saw(Trap::FlashErrorFlags, what);
        } else if offset + usize::from(width) > size {
            let what = format!("EEPROM write at offset {offset:#x}, beyond its {size} bytes");
            witness.saw(Trap::EepromNotReady, what);
        } else if self.registers[FEPROT] >> (offset * 8 / size) & 1 == 0 {
            self.registers[FSTAT] |= FPVIOL;
            witness.saw(
                Trap::FlashProtected,
                format!("EEPROM write at offset {offset:#x}, which FEPROT protects"),
            );
        } else {
            self.memory.write_flexram(address, width, value);
            self.eeprom_writes = self.eeprom_writes.saturating_add(1);
            self.registers[FSTAT] &= !CCIF;
            self.registers[FCNFG] &= !EEERDY;
            self.running = Some(Running {
                until: now + commands::eeprom_write_time(width),
                effect: Effect::EepromWritten(offset..offset + usize::from(width)),
                hides_flash: false,
            });
        }
        true
    }
}

/// A byte whose writing was interrupted.
fn interrupted(old: u8, new: u8) -> u8 {
    let other = old ^ 0x11;
    if other == new { old ^ 0x22 } else { other }
}
