//! Which images are accepted, and what is said about the others.
//!
//! The files are made here, byte by byte, so that every refusal has exactly one reason.

#[path = "image/elf.rs"]
mod elf;

use std::path::Path;

use elf::{ARM, Elf, RAM, good_flash};
use vrduino_emulator::image::{FLASH_SIZE, Image, ImageError};

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
