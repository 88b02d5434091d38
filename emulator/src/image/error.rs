//! Why an image is refused.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::{FLASH_SIZE, RAM};

/// Why a file is not flashed, neither on the emulated board nor on a real one. Every message says
/// what to do about it.
#[derive(Debug)]
#[non_exhaustive]
pub enum ImageError {
    /// The problem, with the file it was found in.
    InFile {
        /// The file, as it was named.
        path: PathBuf,
        /// What is wrong with it.
        problem: Box<ImageError>,
    },
    /// The file cannot be read.
    Read(io::Error),
    /// The file is larger than any image.
    TooLong {
        /// The largest size that is read (bytes).
        limit: u64,
    },
    /// The file is neither ELF nor Intel HEX.
    NotAnImage {
        /// What it seems to be instead.
        content: &'static str,
    },
    /// The file is ELF, but broken.
    DamagedElf {
        /// What does not fit together.
        problem: String,
    },
    /// A program for another processor.
    WrongMachine {
        /// The processor it was built for.
        built_for: String,
    },
    /// An object file or library rather than a linked program.
    NotLinked,
    /// A program that passes numbers in floating-point registers, which this chip does not have.
    HardFloat,
    /// A line of Intel HEX that is wrong.
    HexLine {
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// Intel HEX without its end record.
    HexCut,
    /// Nothing is to be flashed.
    Empty,
    /// Part of the image lies outside the flash.
    OutsideFlash {
        /// Where the part begins.
        address: u64,
        /// How long it is (bytes).
        length: u64,
    },
    /// Variables lie outside the RAM.
    OutsideRam {
        /// The section.
        name: String,
        /// Where it begins.
        address: u64,
        /// How long it is (bytes).
        length: u64,
    },
    /// Two parts of the image claim the same byte.
    Overlap {
        /// The first such byte.
        address: u64,
    },
    /// The image has no vector table at address 0.
    NoVectorTable,
    /// The initial stack pointer is not a usable one.
    Stack {
        /// What the first word of the vector table holds.
        pointer: u32,
    },
    /// The reset vector has its lowest bit clear.
    ResetNotThumb {
        /// What the second word of the vector table holds.
        vector: u32,
    },
    /// The reset vector points to where the image has no code.
    ResetOutside {
        /// What the second word of the vector table holds.
        vector: u32,
    },
    /// The image leaves the flash configuration field erased.
    NoConfiguration,
    /// The image would secure the chip.
    Secured {
        /// The byte at 0x40C.
        fsec: u8,
    },
    /// The image would take away the last way to open a secured chip again.
    MassEraseDisabled {
        /// The byte at 0x40C.
        fsec: u8,
    },
    /// Another byte of the flash configuration field is wrong.
    Configuration {
        /// The field's name in the manual.
        name: &'static str,
        /// What it holds.
        found: Vec<u8>,
        /// What that would do.
        consequence: &'static str,
    },
}

impl ImageError {
    pub(super) fn in_file(self, path: &Path) -> Self {
        Self::InFile {
            path: path.to_path_buf(),
            problem: Box::new(self),
        }
    }
}

/// What a file that is no image seems to be.
pub(super) fn guess(bytes: &[u8]) -> &'static str {
    match bytes {
        [] => "an empty file",
        [b'M', b'Z', ..] => "a Windows program",
        [0xCF | 0xCE, 0xFA, 0xED, 0xFE, ..] | [0xCA, 0xFE, 0xBA, 0xBE, ..] => "a macOS program",
        [b'!', b'<', b'a', b'r', b'c', b'h', b'>', ..] => "a static library",
        [b'U', b'F', b'2', b'\n', ..] => "a UF2 file",
        [b'S', b'0'..=b'9', b'0'..=b'9', ..] => "Motorola S-records",
        _ => "something else",
    }
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InFile { path, problem } => write!(f, "{}: {problem}", path.display()),
            Self::Read(error) => {
                write!(
                    f,
                    "cannot read the image: {error}; build it with `cargo image` or give another file"
                )
            }
            Self::TooLong { limit } => {
                write!(
                    f,
                    "longer than {} MiB, too long for an image; give the linked program",
                    limit >> 20
                )
            }
            Self::NotAnImage { content } => {
                write!(
                    f,
                    "neither ELF nor Intel HEX but {content}; build the image with `cargo image`"
                )
            }
            Self::DamagedElf { problem } => write!(f, "damaged ELF: {problem}; build it again"),
            Self::WrongMachine { built_for } => write!(
                f,
                "built for {built_for}, the Teensy 3.2 needs a 32-bit little-endian ARM (Cortex-M4) image; \
                 build it for thumbv7em-none-eabi"
            ),
            Self::NotLinked => write!(
                f,
                "an ARM object file or library, not a linked program; give the linker's result"
            ),
            Self::HardFloat => write!(
                f,
                "built for a floating-point unit, which the MK20DX256 lacks: the first number would fault; \
                 build it for thumbv7em-none-eabi, not …eabihf"
            ),
            Self::HexLine { line, problem } => {
                write!(
                    f,
                    "line {line} of the Intel HEX is wrong: {problem}; the file is damaged, write it again"
                )
            }
            Self::HexCut => write!(
                f,
                "Intel HEX without its end record: the file is cut; write it again"
            ),
            Self::Empty => write!(f, "the image is empty: was it linked with -Tlink.x?"),
            Self::OutsideFlash { address, length } => write!(
                f,
                "{length} bytes at {address:#010x} lie outside the flash, which ends at {FLASH_SIZE:#010x}; \
                 make the program smaller or correct memory.x"
            ),
            Self::OutsideRam {
                name,
                address,
                length,
            } => write!(
                f,
                "section {name}, {length} bytes at {address:#010x}, lies outside the RAM, {:#010x} to {:#010x}; \
                 make its variables smaller or correct memory.x",
                RAM.start, RAM.end
            ),
            Self::Overlap { address } => write!(
                f,
                "two parts of the image claim the byte at {address:#010x}; correct the linker script or the HEX file"
            ),
            Self::NoVectorTable => write!(
                f,
                "nothing is placed at address 0, where the processor looks for its vector table: \
                 was it linked with -Tlink.x, and not behind a loader?"
            ),
            Self::Stack { pointer } => write!(
                f,
                "the vector table begins with a stack pointer of {pointer:#010x}, which should be a multiple of 4 \
                 in the RAM, {:#010x} to {:#010x}; correct memory.x",
                RAM.start, RAM.end
            ),
            Self::ResetNotThumb { vector } => write!(
                f,
                "the reset vector {vector:#010x} is even, so the processor would fault at once; \
                 build the program as Thumb code"
            ),
            Self::ResetOutside { vector } => write!(
                f,
                "the reset vector {vector:#010x} points to where the image has no code; \
                 was it linked with -Tlink.x for flash at 0?"
            ),
            Self::NoConfiguration => write!(
                f,
                "the image has no flash configuration field at 0x400: erased bytes there would secure the chip \
                 and close its debug port; place the sixteen bytes of .flashconfig at 0x400"
            ),
            Self::Secured { fsec } => write!(
                f,
                "FSEC at 0x40c is {fsec:#04x}: flashing this would secure the chip and close its debug port; \
                 make it 0xfe, and let no code be linked to 0x400..0x410"
            ),
            Self::MassEraseDisabled { fsec } => write!(
                f,
                "FSEC at 0x40c is {fsec:#04x}: flashing this would forbid mass erase, the way back for a chip that is \
                 ever secured, and so could brick it; make it 0xfe, and let no code be linked to 0x400..0x410"
            ),
            Self::Configuration {
                name,
                found,
                consequence,
            } => write!(
                f,
                "{name} in the flash configuration field at 0x400 is {found:02x?}: {consequence}; \
                 let no code be linked to 0x400..0x410"
            ),
        }
    }
}

impl Error for ImageError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Read(error) => Some(error),
            _ => None,
        }
    }
}
