//! What a processor fault was, from the fault status registers (ARMv7-M, B3.2.15 to B3.2.18), and accesses that the
//! engine forgives.

use super::op::Access;
use super::{FLASH_SIZE, Fault, RAM_BASE};
use crate::witness::Trap;

/// Where SRAM_L ends and SRAM_U begins.
const RAM_MIDDLE: u32 = 0x2000_0000;
/// Registers: Device memory.
const PERIPHERALS: std::ops::Range<u32> = 0x4000_0000..0x6000_0000;
const HFSR_DEBUGEVT: u32 = 1 << 31;
const IACCVIOL: u32 = 1 << 0;
const STACKING: u32 = 1 << 3 | 1 << 4 | 1 << 11 | 1 << 12;
const IBUSERR: u32 = 1 << 8;
const PRECISERR: u32 = 1 << 9;
const UNDEFINSTR: u32 = 1 << 16;
const INVSTATE: u32 = 1 << 17;
const INVPC: u32 = 1 << 18;
const NOCP: u32 = 1 << 19;
const UNALIGNED: u32 = 1 << 24;
const DIVBYZERO: u32 = 1 << 25;

/// The engine takes unaligned accesses apart into bytes; these would not work on silicon.
pub(super) fn of_access(access: Access) -> Option<Fault> {
    let Access { address, bytes, .. } = access;
    if address.is_multiple_of(u32::from(bytes)) {
        return None;
    }
    if PERIPHERALS.contains(&address) {
        let what = format!("an access of {bytes} bytes at {address:#010x}, a register");
        return Some(Fault {
            trap: Trap::UnalignedAccess,
            what,
        });
    }
    let crosses = (RAM_BASE..RAM_MIDDLE).contains(&address)
        && address.wrapping_add(u32::from(bytes)) > RAM_MIDDLE;
    crosses.then(|| Fault {
        trap: Trap::SramBoundary,
        what: format!("an access of {bytes} bytes at {address:#010x}"),
    })
}

/// Names the fault that the instruction at `pc` caused; `cfsr` holds the status bits it has set.
pub(super) fn name(
    pc: u32,
    floating: bool,
    access: Option<Access>,
    (cfsr, hfsr, bfar): (u32, u32, u32),
) -> Fault {
    let has = |bits: u32| cfsr & bits != 0;
    let (trap, what) = if hfsr & HFSR_DEBUGEVT != 0 && cfsr == 0 {
        (Trap::Breakpoint, "a BKPT was executed".into())
    } else if has(NOCP) && floating {
        (
            Trap::FpuInstruction,
            "a floating-point instruction was executed".into(),
        )
    } else if has(UNDEFINSTR | NOCP) {
        (
            Trap::UndefinedInstruction,
            "an instruction was executed that this processor does not have".into(),
        )
    } else if has(INVSTATE) {
        (
            Trap::InvalidState,
            "a branch led to an even address, which asks for ARM state".into(),
        )
    } else if has(INVPC) {
        (
            Trap::InvalidState,
            "an exception return that does not fit the active exceptions".into(),
        )
    } else if has(UNALIGNED) {
        let address = access.map_or(0, |access| access.address);
        (
            Trap::UnalignedAccess,
            format!("an access to {address:#010x}, which is not aligned to its size"),
        )
    } else if has(DIVBYZERO) {
        (Trap::DivideByZero, "a division by zero".into())
    } else if has(STACKING) {
        (
            Trap::StackOutside,
            "an exception found no memory for its frame at the stack pointer".into(),
        )
    } else if has(IACCVIOL | IBUSERR) && pc >= PERIPHERALS.start {
        (
            Trap::ExecuteNever,
            format!("an instruction was fetched from {pc:#010x}, where no code can be"),
        )
    } else if has(IBUSERR) {
        (
            Trap::UnmappedMemory,
            format!("an instruction was fetched from {pc:#010x}, where no memory is"),
        )
    } else if has(PRECISERR) {
        let (verb, store) = match access {
            Some(Access { store: true, .. }) => ("write to", true),
            _ => ("read of", false),
        };
        if store && bfar < FLASH_SIZE {
            (
                Trap::FlashStore,
                format!("{verb} {bfar:#010x}, which is flash"),
            )
        } else {
            (
                Trap::UnmappedMemory,
                format!("{verb} {bfar:#010x}, where no memory is"),
            )
        }
    } else if cfsr == 0 {
        (
            Trap::SvcEscalated,
            "an SVC was executed where its handler cannot run".into(),
        )
    } else {
        (
            Trap::UndefinedInstruction,
            format!("a fault with CFSR {cfsr:#010x} and HFSR {hfsr:#010x}"),
        )
    };
    Fault { trap, what }
}
