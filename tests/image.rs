//! The image as it is flashed: it cannot brick a board, it is not empty, and it runs on a core without
//! a floating-point unit.

use std::path::PathBuf;
use std::sync::OnceLock;

use object::{Object, ObjectSection, ObjectSymbol};
use vrduino_emulator::firmware::{self, BuildOptions};
use vrduino_emulator::image::Image;

fn path() -> &'static PathBuf {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| firmware::build(BuildOptions { quiet: true }).expect("the firmware builds"))
}

fn image() -> Image {
    Image::open(path()).expect("the emulator accepts the firmware")
}

/// K20 manual, 28.3.1: no key, nothing protected, unsecured with the backdoor off, default options.
#[test]
fn the_flash_configuration_field_leaves_the_chip_unsecured() {
    let field = &image().flash[0x400..0x410];
    let mut expected = [0xFF; 16];
    expected[0xC] = 0xFE;
    assert_eq!(field, expected);
}

#[test]
fn the_image_holds_a_program_that_fits() {
    let image = image();
    assert!(
        image.flash_used() > 10_000,
        "{} bytes: an empty image",
        image.flash_used()
    );
    assert!(
        image.flash_used() < 80 * 1024,
        "{} bytes of flash",
        image.flash_used()
    );
    let ram = image.ram_used().expect("an ELF tells");
    assert!(ram < 12 * 1024, "{ram} bytes of static RAM");
    assert_eq!(image.stack, 0x2000_8000);
}

#[test]
fn intel_hex_holds_the_same_bytes() {
    let image = image();
    let reread = Image::parse(image.to_hex().as_bytes()).expect("our own HEX is accepted");
    assert_eq!(image.flash, reread.flash);
}

/// A Cortex-M4 without FPU takes a fault at the first coprocessor 10 or 11 instruction.
#[test]
fn no_instruction_needs_a_floating_point_unit() {
    let bytes = std::fs::read(path()).unwrap();
    let elf = object::File::parse(&*bytes).unwrap();
    // Mapping symbols ($t, $d) tell code from the constants between it (ARM ELF specification, 4.5.5).
    let mut marks: Vec<(u64, bool)> = elf
        .symbols()
        .filter_map(|symbol| match symbol.name().ok()?.as_bytes() {
            [b'$', b't', ..] => Some((symbol.address(), true)),
            [b'$', b'd', ..] => Some((symbol.address(), false)),
            _ => None,
        })
        .collect();
    marks.sort();
    let text = elf.section_by_name(".text").expect("there is code");
    let (start, code) = (text.address(), text.data().unwrap());
    let halfword = |at: u64| {
        let offset = (at - start) as usize;
        code.get(offset..offset + 2)
            .map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
    };
    let end = start + code.len() as u64;
    let mut instructions = 0;
    for (index, &(begin, is_code)) in marks.iter().enumerate() {
        if !is_code || !(start..end).contains(&begin) {
            continue;
        }
        let stop = marks[index + 1..]
            .iter()
            .map(|&(at, _)| at)
            .find(|&at| at > begin)
            .unwrap_or(end)
            .min(end);
        let mut at = begin;
        while at < stop {
            let first = halfword(at).unwrap();
            let wide = first >> 11 >= 0b11101;
            if wide && let Some(second) = halfword(at + 2) {
                let coprocessor = first >> 10 & 0b111011 == 0b111011;
                let number = second >> 8 & 0xF;
                assert!(
                    !(coprocessor && matches!(number, 10 | 11)),
                    "{at:#x}: {first:04x} {second:04x} is a floating-point instruction"
                );
            }
            at += if wide { 4 } else { 2 };
            instructions += 1;
        }
    }
    assert!(
        instructions > 5_000,
        "only {instructions} instructions were looked at"
    );
}

/// One stray f64 literal on the board's path pulls in slow routines.
#[test]
fn no_double_precision_routine_is_linked() {
    let bytes = std::fs::read(path()).unwrap();
    let elf = object::File::parse(&*bytes).unwrap();
    let doubles: Vec<&str> = elf
        .symbols()
        .filter_map(|symbol| symbol.name().ok())
        .filter(|name| name.contains("__aeabi_d") || name.contains("df3") || name.contains("2d"))
        // What stands between two memories has the name and the hash of what it calls.
        .filter(|name| name.starts_with("__") && !name.contains("Thunk"))
        .collect();
    assert!(doubles.is_empty(), "{doubles:?}");
}
