//! Which images are accepted, and what is said about the others.
//!
//! The files are made here, byte by byte, so that every refusal has exactly one reason.

use std::path::Path;

use vrduino_emulator::image::{FLASH_SIZE, Image, ImageError};

const EXECUTABLE: u16 = 2;
const ARM: u16 = 40;
const PT_LOAD: u32 = 1;
const SHT_PROGBITS: u32 = 1;
const SHT_SYMTAB: u32 = 2;
const SHT_STRTAB: u32 = 3;
const SHT_NOBITS: u32 = 8;
const OBJECT: u8 = 1;
const FUNCTION: u8 = 2;
const RAM: u32 = 0x1FFF_8000;

/// What a program needs to be accepted: vectors, the flash configuration field, some code.
fn good_flash() -> Vec<u8> {
    let mut flash = vec![0; 0x420];
    flash[..4].copy_from_slice(&0x2000_8000_u32.to_le_bytes());
    flash[4..8].copy_from_slice(&0x411_u32.to_le_bytes());
    flash[0x400..0x410].fill(0xFF);
    flash[0x40C] = 0xFE;
    flash
}

/// The parts of an ELF file, each of which a test can spoil.
struct Elf {
    class: u8,
    order: u8,
    kind: u16,
    machine: u16,
    flags: u32,
    /// Virtual address, physical address, contents.
    segments: Vec<(u32, u32, Vec<u8>)>,
    /// Name, address and size of variables that are not in the file.
    zeroed: (u32, u32),
    /// Name, address, size, type.
    symbols: Vec<(&'static str, u32, u32, u8)>,
}

impl Elf {
    fn good() -> Self {
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

    fn with_flash(change: impl FnOnce(&mut Vec<u8>)) -> Self {
        let mut elf = Self::good();
        change(&mut elf.segments[0].2);
        elf
    }

    fn bytes(&self) -> Vec<u8> {
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

    fn refused(&self) -> ImageError {
        Image::parse(&self.bytes()).map(|_| ()).unwrap_err()
    }
}

#[test]
fn a_good_image_is_where_it_is_loaded() {
    let image = Image::parse(&Elf::good().bytes()).unwrap();
    assert_eq!(image.flash.len(), FLASH_SIZE);
    assert_eq!(image.flash[..0x420], good_flash());
    assert_eq!(image.flash[0x420..0x424], [1, 2, 3, 4]);
    assert!(image.flash[0x424..].iter().all(|&byte| byte == 0xFF));
    assert_eq!((image.stack, image.entry), (0x2000_8000, 0x411));
    assert_eq!(image.flash_used(), 0x424);
    assert_eq!(image.ram_used(), Some(104));
}

#[test]
fn addresses_have_names_and_names_have_addresses() {
    let image = Image::parse(&Elf::good().bytes()).unwrap();
    assert!(image.has_symbols());
    assert_eq!(image.symbol_at(0x410), Some(("main", 0)));
    assert_eq!(image.symbol_at(0x417), Some(("main", 7)));
    assert_eq!(image.symbol_at(0x418), None);
    assert_eq!(image.symbol_at(0), None);
    assert_eq!(image.symbol_at(RAM + 8), Some(("firmware::usb::LINES", 4)));
    assert_eq!(image.address_of("usb::DROPPED_LINES"), Some(RAM));
    assert_eq!(image.address_of("firmware::usb::DROPPED_LINES"), Some(RAM));
    assert_eq!(image.address_of("b::DROPPED_LINES"), None);
    assert_eq!(image.address_of("LINES"), None, "two variables end so");
    assert_eq!(image.address_of("led::LINES"), Some(RAM + 68));
    assert_eq!(image.address_of("__sbss"), Some(RAM + 4));
}

#[test]
fn an_image_survives_intel_hex() {
    let mut elf = Elf::good();
    elf.segments[0].2.resize(0x1_0100, 0xFF);
    elf.segments[0].2[0x1_00FE] = 0x55;
    elf.segments[1].1 = 0x3_FFFC;
    let image = Image::parse(&elf.bytes()).unwrap();
    let hex = image.to_hex();
    assert!(
        hex.lines().any(|line| line.starts_with(":20040000FFFF")),
        "{hex}"
    );
    assert!(hex.trim_end().ends_with(":00000001FF"));
    assert!(hex.len() < 5000, "erased rows are left out");
    let again = Image::parse(hex.as_bytes()).unwrap();
    assert!(again.flash == image.flash);
    assert_eq!((again.stack, again.entry), (image.stack, image.entry));
    assert_eq!(again.ram_used(), None);
    assert!(!again.has_symbols());
}

#[test]
fn other_peoples_configuration_bytes_are_fine() {
    for (fsec, fopt) in [(0xFE, 0xFF), (0xDE, 0xF9), (0xDE, 0xFB), (0x7E, 0xFE)] {
        let elf = Elf::with_flash(|flash| {
            flash[0x40C] = fsec;
            flash[0x40D] = fopt;
        });
        assert!(Image::parse(&elf.bytes()).is_ok(), "{fsec:02x} {fopt:02x}");
    }
}

#[test]
fn an_image_that_would_lock_the_chip_is_refused() {
    for fsec in [0xFF, 0xFC, 0xFD, 0x00] {
        let elf = Elf::with_flash(|flash| flash[0x40C] = fsec);
        let error = elf.refused();
        assert!(matches!(error, ImageError::Secured { .. }), "{error}");
        assert!(error.to_string().contains("would secure the chip"));
    }
    let error = Elf::with_flash(|flash| flash[0x40C] = 0xEE).refused();
    assert!(
        matches!(error, ImageError::MassEraseDisabled { fsec: 0xEE }),
        "{error}"
    );
    for (offset, field) in [
        (0x400, "backdoor key"),
        (0x407, "backdoor key"),
        (0x408, "FPROT"),
        (0x40B, "FPROT"),
        (0x40D, "FOPT"),
        (0x40E, "FEPROT"),
        (0x40F, "FDPROT"),
    ] {
        match Elf::with_flash(|flash| flash[offset] = 0x7F).refused() {
            ImageError::Configuration { name, .. } => assert_eq!(name, field),
            other => panic!("{offset:#x}: {other}"),
        }
    }
    let mut elf = Elf::good();
    elf.segments[0].2.truncate(0x40F);
    elf.segments[0].2[4..8].copy_from_slice(&0x101_u32.to_le_bytes());
    assert!(matches!(elf.refused(), ImageError::NoConfiguration));
}

#[test]
fn a_program_for_another_processor_is_named() {
    for (class, order, machine, name) in [
        (2, 1, 62, "x86-64"),
        (2, 1, 183, "AArch64"),
        (1, 1, 243, "RISC-V"),
        (1, 1, 94, "Xtensa"),
        (1, 1, 83, "AVR"),
        (1, 1, 999, "machine number 999"),
    ] {
        let error = Elf {
            class,
            order,
            machine,
            ..Elf::good()
        }
        .refused()
        .to_string();
        assert!(
            error.starts_with(&format!("built for {name}, the Teensy 3.2 needs")),
            "{error}"
        );
    }
    let error = Elf {
        order: 2,
        machine: ARM.swap_bytes(),
        ..Elf::good()
    }
    .refused();
    assert!(error.to_string().contains("big-endian ARM"), "{error}");
    assert!(matches!(
        Elf {
            kind: 1,
            ..Elf::good()
        }
        .refused(),
        ImageError::NotLinked
    ));
    assert!(matches!(
        Elf {
            flags: 0x0500_0400,
            ..Elf::good()
        }
        .refused(),
        ImageError::HardFloat
    ));
    let this = std::fs::read(std::env::current_exe().unwrap()).unwrap();
    assert!(
        Image::parse(&this).is_err(),
        "this test program is not for the board"
    );
}

#[test]
fn an_image_that_would_not_start_is_refused() {
    let word = |offset: usize, value: u32| {
        Elf::with_flash(|flash| flash[offset..offset + 4].copy_from_slice(&value.to_le_bytes()))
            .refused()
    };
    for stack in [0, RAM, RAM - 4, 0x2000_8004, 0x2000_7FFE, u32::MAX] {
        assert!(matches!(word(0, stack), ImageError::Stack { pointer } if pointer == stack));
    }
    assert!(matches!(
        word(4, 0x410),
        ImageError::ResetNotThumb { vector: 0x410 }
    ));
    for vector in [0x1001, 0x4_0001, RAM + 1, u32::MAX] {
        assert!(matches!(word(4, vector), ImageError::ResetOutside { .. }));
    }
    let mut elf = Elf::good();
    elf.segments[0].1 = 0x100;
    elf.segments.truncate(1);
    assert!(matches!(elf.refused(), ImageError::NoVectorTable));
    let error = Elf {
        segments: Vec::new(),
        ..Elf::good()
    }
    .refused();
    assert_eq!(
        error.to_string(),
        "the image is empty: was it linked with -Tlink.x?"
    );
}

#[test]
fn an_image_that_does_not_fit_is_refused() {
    let load = |address: u32| {
        let mut elf = Elf::good();
        elf.segments[1].1 = address;
        elf.refused()
    };
    assert!(matches!(
        load(0x3_FFFD),
        ImageError::OutsideFlash {
            address: 0x3_FFFD,
            length: 4
        }
    ));
    assert!(matches!(load(RAM), ImageError::OutsideFlash { .. }));
    assert!(matches!(load(u32::MAX), ImageError::OutsideFlash { .. }));
    assert!(matches!(
        load(0x41E),
        ImageError::Overlap { address: 0x41E }
    ));
    let zeroed = |address, size| {
        Elf {
            zeroed: (address, size),
            ..Elf::good()
        }
        .refused()
    };
    assert!(matches!(
        zeroed(RAM + 4, 65_533),
        ImageError::OutsideRam { .. }
    ));
    assert!(matches!(
        zeroed(u32::MAX, u32::MAX),
        ImageError::OutsideRam { .. }
    ));
}

#[test]
fn wrong_intel_hex_is_refused_with_its_line() {
    let good = Image::parse(&Elf::good().bytes()).unwrap().to_hex();
    let line = |text: &str| match Image::parse(text.as_bytes()) {
        Err(ImageError::HexLine { line, problem }) => (line, problem),
        other => panic!("{other:?}"),
    };
    let second = good.lines().nth(1).unwrap();
    let (digits, checksum) = second.split_at(second.len() - 2);
    let wrong = if checksum == "00" { "01" } else { "00" };
    let (number, problem) = line(&good.replace(second, &format!("{digits}{wrong}")));
    assert_eq!(number, 2);
    assert_eq!(
        problem,
        format!("its checksum is {wrong} but its bytes give {checksum}")
    );
    assert_eq!(line(&good.replacen(second, &second[1..], 1)).0, 2);
    assert_eq!(line(&good.replacen(second, ":é", 1)).0, 2);
    assert_eq!(line(":\n").0, 1);
    assert!(matches!(
        Image::parse(second.as_bytes()),
        Err(ImageError::HexCut)
    ));
    assert!(matches!(
        Image::parse(b":00000001FF\n"),
        Err(ImageError::Empty)
    ));
    let twice = good.replacen(second, &format!("{second}\n{second}"), 1);
    assert!(matches!(
        Image::parse(twice.as_bytes()),
        Err(ImageError::Overlap { address: 0x20 })
    ));
    let far = format!(":020000040004F6\n{good}");
    assert!(matches!(
        Image::parse(far.as_bytes()),
        Err(ImageError::OutsideFlash {
            address: 0x4_0000,
            ..
        })
    ));
}

#[test]
fn anything_else_is_refused_without_a_panic() {
    for (bytes, content) in [
        (&b""[..], "an empty file"),
        (b"MZ\x90\0", "a Windows program"),
        (b"\xCF\xFA\xED\xFE", "a macOS program"),
        (b"!<arch>\n", "a static library"),
        (b"\xFF\xFE\xFD", "something else"),
    ] {
        let error = Image::parse(bytes).unwrap_err().to_string();
        assert!(error.contains(content), "{error}");
    }
    let good = Elf::good().bytes();
    for length in (0..good.len()).filter(|length| *length < 400 || length % 7 == 0) {
        assert!(Image::parse(&good[..length]).is_err(), "cut to {length}");
    }
    // Every byte of the headers and tables, spoilt one at a time.
    let tables = (0..200).chain(good.len() - 700..good.len());
    for offset in tables {
        for value in [0, 0x7F, 0x80, 0xFF] {
            let mut bytes = good.clone();
            bytes[offset] = value;
            let _ = Image::parse(&bytes)
                .map(|image| (image.to_hex(), image.symbol_at(0x410).is_some()));
        }
    }
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    for path in [
        Path::new("no/such/image.elf"),
        Path::new(env!("CARGO_MANIFEST_DIR")),
    ] {
        let error = Image::open(path).unwrap_err().to_string();
        assert!(error.starts_with(&path.display().to_string()), "{error}");
        assert!(error.contains("cannot read"), "{error}");
    }
}
