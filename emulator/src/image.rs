//! The image: what is flashed, read from the same file.
//!
//! An [`Image`] comes from an ELF file or from Intel HEX, recognised by its content. ELF segments go
//! where they are loaded (the physical address), not where they run. Before an image is accepted it
//! is looked at as a careful person would before flashing it: is it for this chip, does it fit, would
//! the processor start, and would the chip still open its debug and loader doors afterwards (see
//! [`configuration`])?
//!
//! Memory of the MK20DX256 (K20 Sub-Family Reference Manual, chapter 4): 256 KiB of flash from 0 and
//! 64 KiB of RAM around 0x2000_0000.

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::Path;

pub mod configuration;

mod elf;

mod error;

mod flash;

mod hex;

mod symbols;

pub use error::ImageError;
pub use symbols::{Symbol, SymbolKind, Symbols};

use flash::Flash;

/// Size of the flash (bytes); it begins at address 0.
pub const FLASH_SIZE: usize = 256 * 1024;

/// The RAM, SRAM_L and SRAM_U side by side.
pub const RAM: Range<u32> = 0x1FFF_8000..0x2000_8000;

/// Size of the RAM (bytes).
pub const RAM_SIZE: usize = 64 * 1024;

/// The largest file that is read (bytes); an ELF with all its debug information is far below.
const FILE_LIMIT: u64 = 256 * 1024 * 1024;

/// A program as it stands in the flash of the chip.
#[derive(Debug, Clone)]
pub struct Image {
    /// All of the flash; erased bytes are 0xFF.
    pub flash: Vec<u8>,
    /// Where the processor starts: the reset vector, its lowest bit set for Thumb code.
    pub entry: u32,
    /// The stack pointer the processor starts with.
    pub stack: u32,
    /// Names of functions and variables; empty if the file has none, as Intel HEX never does.
    pub symbols: Symbols,
    used: usize,
    ram: Option<usize>,
    data_end: u32,
}

impl Image {
    /// Reads the image in a file.
    ///
    /// # Errors
    ///
    /// [`ImageError::InFile`] with the path and what is wrong: see [`Image::parse`].
    pub fn open(path: &Path) -> Result<Self, ImageError> {
        read(path)
            .and_then(|bytes| Self::parse(&bytes))
            .map_err(|problem| problem.in_file(path))
    }

    /// Reads an image from the bytes of an ELF file or of Intel HEX.
    ///
    /// # Errors
    ///
    /// [`ImageError`] if the bytes are neither, are damaged, are a program for something else than
    /// this chip, do not fit it, would not start, or would lock it.
    pub fn parse(bytes: &[u8]) -> Result<Self, ImageError> {
        let (flash, symbols, ram, data_end) = if bytes.starts_with(b"\x7FELF") {
            let program = elf::read(bytes)?;
            (
                program.flash,
                program.symbols,
                Some(program.ram_used),
                program.data_end,
            )
        } else if let Some(text) = hex::text(bytes) {
            (hex::read(text)?, Symbols::default(), None, RAM.start)
        } else {
            return Err(ImageError::NotAnImage {
                content: error::guess(bytes),
            });
        };
        if flash.used() == 0 {
            return Err(ImageError::Empty);
        }
        let (stack, entry) = vectors(&flash)?;
        configuration::check(&flash)?;
        let used = flash.used();
        Ok(Self {
            flash: flash.into_bytes(),
            entry,
            stack,
            symbols,
            used,
            ram,
            data_end,
        })
    }

    /// The function or variable that `address` lies in, and how far into it (bytes).
    pub fn symbol_at(&self, address: u32) -> Option<(&str, u32)> {
        self.symbols.at(address)
    }

    /// The address of the symbol whose path ends in `path`, such as `usb::DROPPED_LINES`.
    ///
    /// A path is matched by whole parts from its end. `None` if no symbol answers to it, or if
    /// several at different addresses do.
    pub fn address_of(&self, path: &str) -> Option<u32> {
        self.symbols.address_of(path)
    }

    /// Whether the file named anything; without names, messages can only give addresses.
    pub fn has_symbols(&self) -> bool {
        !self.symbols.is_empty()
    }

    /// How much of the flash the program takes (bytes), from 0 to its last byte.
    pub fn flash_used(&self) -> usize {
        self.used
    }

    /// How much of the RAM is taken before the program starts (bytes): its variables, without the
    /// stack. `None` if the file does not say, as Intel HEX does not.
    pub fn ram_used(&self) -> Option<usize> {
        self.ram
    }

    /// Where the program's variables end in RAM: a stack that grows below this overwrites them. The beginning of the
    /// RAM if the file does not say, or if a section lies above the stack.
    pub fn data_end(&self) -> u32 {
        if self.data_end < self.stack {
            self.data_end
        } else {
            RAM.start
        }
    }

    /// The image as Intel HEX, for a loader.
    ///
    /// Rows of erased bytes are left out, except the row with the flash configuration field: what it
    /// holds is never left to chance.
    pub fn to_hex(&self) -> String {
        hex::write(&self.flash[..self.used])
    }
}

/// The first two words of the vector table: initial stack pointer and reset vector.
fn vectors(flash: &Flash) -> Result<(u32, u32), ImageError> {
    let (Some(stack), Some(reset)) = (flash.word(0), flash.word(4)) else {
        return Err(ImageError::NoVectorTable);
    };
    // The stack grows down from its first word, so it may begin just behind the RAM but not at its
    // very start.
    if !stack.is_multiple_of(4) || stack <= RAM.start || stack > RAM.end {
        return Err(ImageError::Stack { pointer: stack });
    }
    if reset & 1 == 0 {
        return Err(ImageError::ResetNotThumb { vector: reset });
    }
    if flash.halfword(reset & !1).is_none() {
        return Err(ImageError::ResetOutside { vector: reset });
    }
    Ok((stack, reset))
}

fn read(path: &Path) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(FILE_LIMIT + 1).read_to_end(&mut bytes))
        .map_err(ImageError::Read)?;
    if bytes.len() as u64 > FILE_LIMIT {
        return Err(ImageError::TooLong { limit: FILE_LIMIT });
    }
    Ok(bytes)
}
