//! ELF files made byte by byte.

use vrduino_emulator::image::{Image, ImageError};

const EXECUTABLE: u16 = 2;
pub const ARM: u16 = 40;
const PT_LOAD: u32 = 1;
const SHT_PROGBITS: u32 = 1;
const SHT_SYMTAB: u32 = 2;
const SHT_STRTAB: u32 = 3;
const SHT_NOBITS: u32 = 8;
const OBJECT: u8 = 1;
const FUNCTION: u8 = 2;
pub const RAM: u32 = 0x1FFF_8000;

/// What a program needs to be accepted: vectors, the flash configuration field, some code.
pub fn good_flash() -> Vec<u8> {
    let mut flash = vec![0; 0x420];
    flash[..4].copy_from_slice(&0x2000_8000_u32.to_le_bytes());
    flash[4..8].copy_from_slice(&0x411_u32.to_le_bytes());
    flash[0x400..0x410].fill(0xFF);
    flash[0x40C] = 0xFE;
    flash
}

/// The parts of an ELF file, each of which a test can spoil.
pub struct Elf {
    pub class: u8,
    pub order: u8,
    pub kind: u16,
    pub machine: u16,
    pub flags: u32,
    /// Virtual address, physical address, contents.
    pub segments: Vec<(u32, u32, Vec<u8>)>,
    /// Name, address and size of variables that are not in the file.
    pub zeroed: (u32, u32),
    /// Name, address, size, type.
    pub symbols: Vec<(&'static str, u32, u32, u8)>,
}

impl Elf {
    pub fn good() -> Self {
        Self {
            class: 1,
            order: 1,
            kind: EXECUTABLE,
            machine: ARM,
            flags: 0x0500_0200,
            segments: vec![(0, 0, good_flash()), (RAM, 0x420, vec![1, 2, 3, 4])],
            zeroed: (RAM + 4, 100),
            symbols: vec![
                ("main", 0x411, 8, FUNCTION),
                (
                    "_ZN8firmware3usb13DROPPED_LINES17h0123456789abcdefE",
                    RAM,
                    4,
                    OBJECT,
                ),
                (
                    "_ZN8firmware3usb5LINES17h0123456789abcdefE",
                    RAM + 4,
                    64,
                    OBJECT,
                ),
                (
                    "_ZN8firmware3led5LINES17h0123456789abcdefE",
                    RAM + 68,
                    4,
                    OBJECT,
                ),
                ("__sbss", RAM + 4, 0, 0),
                ("$t", 0x410, 0, 0),
            ],
        }
    }

    pub fn with_flash(change: impl FnOnce(&mut Vec<u8>)) -> Self {
        let mut elf = Self::good();
        change(&mut elf.segments[0].2);
        elf
    }

    pub fn bytes(&self) -> Vec<u8> {
        let words =
            |values: &[u32]| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
        let mut data = Vec::new();
        let mut place = |bytes: &[u8]| -> (u32, u32) {
            data.extend_from_slice(bytes);
            (
                0x1000 + (data.len() - bytes.len()) as u32,
                bytes.len() as u32,
            )
        };
        let mut programs = Vec::new();
        let mut sections = words(&[0; 10]);
        for (address, load, contents) in &self.segments {
            let (offset, size) = place(contents);
            programs.extend(words(&[PT_LOAD, offset, *address, *load, size, size, 7, 4]));
            sections.extend(words(&[
                0,
                SHT_PROGBITS,
                2,
                *address,
                offset,
                size,
                0,
                0,
                4,
                0,
            ]));
        }
        let (address, size) = self.zeroed;
        sections.extend(words(&[1, SHT_NOBITS, 3, address, 0, size, 0, 0, 4, 0]));
        let mut strings = b"\0.bss\0".to_vec();
        let mut symbols = words(&[0; 4]);
        for (name, value, size, kind) in &self.symbols {
            symbols.extend(words(&[strings.len() as u32, *value, *size]));
            symbols.extend([*kind, 0, 1, 0]);
            strings.extend(name.bytes().chain([0]));
        }
        let count = (sections.len() / 40) as u32;
        let (offset, size) = place(&symbols);
        sections.extend(words(&[
            0,
            SHT_SYMTAB,
            0,
            0,
            offset,
            size,
            count + 1,
            1,
            4,
            16,
        ]));
        let (offset, size) = place(&strings);
        sections.extend(words(&[0, SHT_STRTAB, 0, 0, offset, size, 0, 0, 1, 0]));
        let sections_at = 0x1000 + data.len() as u32;

        let mut bytes = vec![
            0x7F, b'E', b'L', b'F', self.class, self.order, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0,
        ];
        bytes.extend(self.kind.to_le_bytes());
        bytes.extend(self.machine.to_le_bytes());
        bytes.extend(words(&[1, 0x411, 52, sections_at, self.flags]));
        let halves = [
            52,
            32,
            self.segments.len() as u16,
            40,
            count as u16 + 2,
            count as u16 + 1,
        ];
        bytes.extend(halves.iter().flat_map(|half| half.to_le_bytes()));
        bytes.extend(programs);
        bytes.resize(0x1000, 0);
        bytes.extend(data);
        bytes.extend(sections);
        bytes
    }

    pub fn refused(&self) -> ImageError {
        Image::parse(&self.bytes()).map(|_| ()).unwrap_err()
    }
}
