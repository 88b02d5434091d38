//! The chip's EEPROM (K20 manual, chapter 28, "Flash Memory Module (FTFL)"): FlexRAM is read like any
//! memory, and a word written there goes into FlexNVM by itself.
//!
//! FlexNVM is another block than program flash, so the program runs on while a word is written; only
//! FlexRAM must be left alone until EEERDY is set again. Making the EEPROM out of FlexNVM, once in a
//! chip's life, is different: no flash at all can be read meanwhile.
//!
//! Not the HAL's `eeprom`: that waits without a limit, in flash, and writes bytes, which wears twice as
//! much as words.

use core::ptr;

use mk20dx_hal::pac;

use super::super::breadcrumb::{self, Stage};
use super::super::clock::Deadline;
use super::StoreError;

const FLEXRAM: usize = 0x1400_0000;
/// Bytes of FlexRAM, and of EEPROM as Teensyduino makes it.
const FLEXRAM_LENGTH: usize = 2048;

/// Program Partition, by the codes of Teensyduino's `eeprom.c`, so that a sketch and we find the same
/// EEPROM: 2 KiB in two equal halves, all of FlexNVM behind it.
const PROGRAM_PARTITION: u8 = 0x80;
const DATA_SET_SIZE: u8 = 0x33;
const NO_DATA_FLASH: u8 = 0x03;

/// SIM_FCFG1[DEPART] and [EESIZE] of a chip that was never partitioned.
const NONE: u8 = 0xF;
/// EESIZE of 2 KiB; each further code halves it.
const LARGEST: u8 = 3;

/// FSTAT: no command runs.
const CCIF: u8 = 0x80;
/// FSTAT: read collision, access error, protection violation; cleared by writing ones.
const REFUSED: u8 = 0x70;
/// FSTAT: the last command failed.
const MGSTAT0: u8 = 0x01;

/// Longest wait for the reset sequence, which gathers the EEPROM's words in FlexRAM.
const START_US: u32 = 50_000;

/// An EEPROM that is ready.
pub struct Eeprom {
    registers: pac::Ftfl,
    length: usize,
}

impl Eeprom {
    /// Waits until FlexRAM shows the EEPROM; makes it first on a chip that never had one, if
    /// `may_partition`.
    ///
    /// Making it takes 70 ms (data sheet, typical), in which nothing else happens: to be called before
    /// anything is started that an interrupt has to serve.
    pub fn new(
        registers: pac::Ftfl,
        sim: &pac::Sim,
        may_partition: bool,
    ) -> Result<Eeprom, StoreError> {
        let configuration = sim.fcfg1().read();
        let code = configuration.eesize().bits();
        let blank = code == NONE && configuration.depart().bits() == NONE;
        let mut eeprom = Eeprom {
            registers,
            length: match code.checked_sub(LARGEST) {
                // FCFG1 may show it from the next reset on only.
                _ if blank => FLEXRAM_LENGTH,
                Some(halvings) => FLEXRAM_LENGTH >> halvings,
                None => 0,
            },
        };
        wait(|| eeprom.is_idle())?;
        if blank && eeprom.registers.fcnfg().read().ramrdy().bit() {
            if !may_partition {
                return Err(StoreError::Hung);
            }
            eeprom.partition()?;
        }
        wait(|| eeprom.is_ready())?;
        Ok(eeprom)
    }

    /// Bytes of EEPROM.
    pub fn length(&self) -> usize {
        self.length
    }

    /// Whether FlexRAM may be used: the last word has been written.
    pub fn is_ready(&self) -> bool {
        self.is_idle() && self.registers.fcnfg().read().eeerdy().bit()
    }

    /// Whether the last word was accepted.
    pub fn check(&self) -> Result<(), StoreError> {
        match self.registers.fstat().read().bits() & (REFUSED | MGSTAT0) {
            0 => Ok(()),
            flags => Err(StoreError::Refused(flags)),
        }
    }

    /// Forgets what was refused before: nothing is written while a flag is set.
    pub fn clear(&mut self) {
        // SAFETY: ones clear these flags; CCIF, which would launch a command, is written as zero.
        self.registers.fstat().write(|w| unsafe { w.bits(REFUSED) });
    }

    /// The word at `offset`, a multiple of four within [`length`](Self::length). Only while ready.
    pub fn word(&self, offset: usize) -> u32 {
        let address = ptr::with_exposed_provenance::<u32>(FLEXRAM + offset % FLEXRAM_LENGTH);
        // SAFETY: FlexRAM is memory at this fixed address, which nobody else uses.
        unsafe { address.read_volatile() }
    }

    /// Begins to write the word at `offset`, a multiple of four within [`length`](Self::length). Only
    /// while ready, which it is not for 0.6 ms from now (data sheet, typical).
    pub fn write(&mut self, offset: usize, word: u32) {
        let address = ptr::with_exposed_provenance_mut::<u32>(FLEXRAM + offset % FLEXRAM_LENGTH);
        // SAFETY: as in `word`; the controller takes the write up.
        unsafe { address.write_volatile(word) }
    }

    fn is_idle(&self) -> bool {
        self.registers.fstat().read().ccif().bit()
    }

    /// Program Partition. Its only limit is the watchdog: before its end there is no program to go back
    /// to. The breadcrumb keeps the next life from trying again.
    fn partition(&mut self) -> Result<(), StoreError> {
        breadcrumb::mark(Stage::Partitioning);
        self.clear();
        let command = [PROGRAM_PARTITION, 0, 0, 0, DATA_SET_SIZE, NO_DATA_FLASH];
        for (n, byte) in command.into_iter().enumerate() {
            // FCCOB3 to 0 stand in this order, then 7 to 4.
            // SAFETY: the command's parameters, any of which the controller checks.
            self.registers
                .fccob(n ^ 3)
                .write(|w| unsafe { w.bits(byte) });
        }
        // An interrupt's handler is in flash.
        // SAFETY: CCIF can be read and launches what stands in FCCOB.
        cortex_m::interrupt::free(|_| unsafe { launch(self.registers.fstat().as_ptr()) });
        self.check()
    }
}

/// Waits until `ready`, as long as the reset sequence may take.
fn wait(ready: impl Fn() -> bool) -> Result<(), StoreError> {
    let limit = Deadline::in_us(START_US);
    while !ready() {
        if limit.passed() {
            return Err(StoreError::NotReady);
        }
    }
    Ok(())
}

/// Launches a command and waits for its end, in RAM: flash cannot be read meanwhile.
///
/// # Safety
///
/// `fstat` is the register, and no interrupt may come.
#[inline(never)]
// SAFETY: start-up copies this section to RAM; there is nothing else in it.
#[unsafe(link_section = ".data.launch")]
unsafe fn launch(fstat: *mut u8) {
    // SAFETY: by the caller.
    unsafe { fstat.write_volatile(CCIF) };
    // SAFETY: by the caller.
    while unsafe { fstat.read_volatile() } & CCIF == 0 {}
}
