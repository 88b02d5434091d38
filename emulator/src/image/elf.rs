//! ELF: the file the linker writes.

use object::elf::{FileHeader32, PT_LOAD, SHF_ALLOC};
use object::read::elf::{ElfFile, ProgramHeader, SectionHeader};
use object::{LittleEndian, Object, ObjectSection, ObjectSymbol, SymbolKind as Kind};

use super::flash::Flash;
use super::symbols::{Symbol, SymbolKind, Symbols};
use super::{ImageError, RAM};

// Offsets and values of the ELF header's fields (Tool Interface Standard, ELF 1.2, figure 1-3).
const CLASS: usize = 4;
const CLASS_32: u8 = 1;
const DATA: usize = 5;
const DATA_LITTLE: u8 = 1;
const TYPE: usize = 16;
const TYPE_EXECUTABLE: u16 = 2;
const MACHINE: usize = 18;
const MACHINE_ARM: u16 = 40;
const FLAGS: usize = 36;
/// EF_ARM_ABI_FLOAT_HARD (ELF for the Arm Architecture, table 4-2).
const FLAG_HARD_FLOAT: u16 = 0x400;

/// What an ELF file says about a program.
pub(super) struct Program {
    pub(super) flash: Flash,
    pub(super) symbols: Symbols,
    pub(super) ram_used: usize,
    pub(super) data_end: u32,
}

pub(super) fn read(bytes: &[u8]) -> Result<Program, ImageError> {
    check_target(bytes)?;
    let damaged = |error: object::Error| ImageError::DamagedElf {
        problem: error.to_string(),
    };
    let file = ElfFile::<FileHeader32<LittleEndian>>::parse(bytes).map_err(damaged)?;

    let mut flash = Flash::erased();
    for segment in file.elf_program_headers() {
        if segment.p_type(LittleEndian) != PT_LOAD {
            continue;
        }
        let data = segment
            .data(LittleEndian, bytes)
            .map_err(|()| ImageError::DamagedElf {
                problem: "a segment lies outside the file".to_owned(),
            })?;
        if !data.is_empty() {
            flash.program(u64::from(segment.p_paddr(LittleEndian)), data)?;
        }
    }
    let (ram_used, data_end) = ram_used(&file)?;
    Ok(Program {
        flash,
        symbols: symbols(&file),
        ram_used,
        data_end,
    })
}

/// Says plainly what a file is that is a good ELF but not for this chip.
fn check_target(bytes: &[u8]) -> Result<(), ImageError> {
    let damaged = || ImageError::DamagedElf {
        problem: "it ends inside its header".to_owned(),
    };
    let byte = |at: usize| bytes.get(at).copied().ok_or_else(damaged);
    let (class, order) = (byte(CLASS)?, byte(DATA)?);
    let half = |at: usize| -> Result<u16, ImageError> {
        let pair = [byte(at)?, byte(at + 1)?];
        Ok(if order == DATA_LITTLE {
            u16::from_le_bytes(pair)
        } else {
            u16::from_be_bytes(pair)
        })
    };
    let machine = half(MACHINE)?;
    if (class, order, machine) != (CLASS_32, DATA_LITTLE, MACHINE_ARM) {
        return Err(ImageError::WrongMachine {
            built_for: machine_name(machine, order),
        });
    }
    if half(TYPE)? != TYPE_EXECUTABLE {
        return Err(ImageError::NotLinked);
    }
    if half(FLAGS)? & FLAG_HARD_FLOAT != 0 {
        return Err(ImageError::HardFloat);
    }
    Ok(())
}

/// The name people use for an `e_machine` value.
fn machine_name(machine: u16, order: u8) -> String {
    let name = match machine {
        2 | 18 | 43 => "SPARC",
        3 => "32-bit x86",
        4 => "68000",
        8 | 10 => "MIPS",
        20 => "PowerPC",
        21 => "64-bit PowerPC",
        22 => "S/390",
        MACHINE_ARM if order != DATA_LITTLE => "big-endian ARM",
        MACHINE_ARM => "64-bit ARM",
        62 => "x86-64",
        83 => "AVR",
        94 => "Xtensa",
        105 => "MSP430",
        183 => "AArch64",
        243 => "RISC-V",
        258 => "LoongArch",
        other => return format!("machine number {other}"),
    };
    name.to_owned()
}

fn symbols(file: &ElfFile<'_, FileHeader32<LittleEndian>>) -> Symbols {
    let named = file.symbols().filter_map(|symbol| {
        let kind = match symbol.kind() {
            _ if symbol.is_undefined() => return None,
            Kind::Text => SymbolKind::Function,
            Kind::Data => SymbolKind::Object,
            Kind::Unknown => SymbolKind::Mark,
            _ => return None,
        };
        let raw = symbol.name().ok()?;
        // `$t`, `$d` and their like only tell code from data (ELF for the Arm Architecture, 4.5.5).
        if raw.is_empty() || raw.starts_with('$') {
            return None;
        }
        let address = u32::try_from(symbol.address()).ok()?;
        Some(Symbol {
            address: if kind == SymbolKind::Function {
                address & !1
            } else {
                address
            },
            size: u32::try_from(symbol.size()).ok()?,
            kind,
            name: format!("{:#}", rustc_demangle::demangle(raw)),
        })
    });
    Symbols::new(named.collect())
}

/// The bytes of RAM that sections take, and where the last of them ends.
fn ram_used(file: &ElfFile<'_, FileHeader32<LittleEndian>>) -> Result<(usize, u32), ImageError> {
    let mut used = 0_u64;
    let mut end = u64::from(RAM.start);
    for section in file.sections() {
        let header = section.elf_section_header();
        let begin = section.address();
        if header.sh_flags(LittleEndian).contains(SHF_ALLOC)
            && begin >= u64::from(RAM.start)
            && section.size() > 0
        {
            if begin + section.size() > u64::from(RAM.end) {
                let name = section.name().unwrap_or("?").to_owned();
                return Err(ImageError::OutsideRam {
                    name,
                    address: begin,
                    length: section.size(),
                });
            }
            used += section.size();
            end = end.max(begin + section.size());
        }
    }
    let end = u32::try_from(end).unwrap_or(RAM.end);
    Ok((usize::try_from(used).unwrap_or(usize::MAX), end))
}
