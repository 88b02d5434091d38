//! Commands of the flash module (K20 manual, FTFL).

use crate::chip::{read, write};

const FSTAT: u32 = 0x4002_0000;
const FCCOB3: u32 = 0x4002_0004;
const FPROT3: u32 = 0x4002_0010;
const CCIF: u8 = 0x80;

/// Program Longword.
pub const PROGRAM_LONGWORD: u8 = 0x06;
/// Erase Flash Sector.
pub const ERASE_SECTOR: u8 = 0x09;
/// A sector far behind the program.
pub const SECTOR: u32 = 0x0003_0000;

/// Writes a command, its address and no data.
pub fn load(code: u8, address: u32) {
    write(FCCOB3, u32::from(code) << 24 | address);
    write(FCCOB3 + 4, 0u32);
}

/// Loads Program Partition: 2 KiB of EEPROM in all of the FlexNVM.
pub fn load_partition() {
    write(FCCOB3, 0x8000_0000u32);
    write(FCCOB3 + 4, 0x3303_0000u32);
}

/// Loads Set FlexRAM Function: EEPROM.
pub fn load_eeprom() {
    write(FCCOB3, 0x8100_0000u32);
}

/// Launches what is loaded and waits for its end, in RAM.
#[cfg_attr(target_os = "none", unsafe(link_section = ".data.launch"))]
#[inline(never)]
pub fn launch() {
    write(FSTAT, CCIF);
    while read::<u8>(FSTAT) & CCIF == 0 {}
}

/// The same in flash, where nothing can be read meanwhile.
#[inline(never)]
pub fn launch_from_flash() {
    write(FSTAT, CCIF);
    while read::<u8>(FSTAT) & CCIF == 0 {}
}

/// Launches what is loaded, and once more at once, in RAM.
#[cfg_attr(target_os = "none", unsafe(link_section = ".data.launch_twice"))]
#[inline(never)]
pub fn launch_twice() {
    write(FSTAT, CCIF);
    write(FSTAT, CCIF);
    while read::<u8>(FSTAT) & CCIF == 0 {}
}

/// Protects the lowest 1/32 of the flash, the vectors' and the program's.
pub fn protect() {
    write(FPROT3, 0xFEu8);
}
