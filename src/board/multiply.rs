//! The multiply instructions that a compiler does not find by itself.

#![allow(unsafe_code, reason = "one instruction each")]

use core::arch::asm;
use vrduino::fixed::multiply::Multiply;

/// By the instructions of the Cortex-M4's DSP extension, one for each operation.
///
/// None is marked `pure`: the compiler leaves them in the order in which they are written, and that
/// order keeps fewer values waiting on the stack than its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instructions;

impl Multiply for Instructions {
    #[inline(always)]
    fn high(a: i32, b: i32) -> i32 {
        let result;
        // SAFETY: it reads two registers and writes one; no flag, no memory.
        unsafe {
            asm!("smmulr {}, {}, {}", lateout(reg) result, in(reg) a, in(reg) b, options(nomem, nostack, preserves_flags));
        }
        result
    }

    #[inline(always)]
    fn add_wide(sum: i64, a: i32, b: i32) -> i64 {
        let (mut lower, mut upper) = (sum as u32, (sum >> 32) as i32);
        // SAFETY: it reads four registers and writes two of them; no flag, no memory.
        unsafe {
            asm!("smlal {}, {}, {}, {}", inlateout(reg) lower, inlateout(reg) upper, in(reg) a, in(reg) b, options(nomem, nostack, preserves_flags));
        }
        i64::from(upper) << 32 | i64::from(lower)
    }

    #[inline(always)]
    fn add_high(sum: i32, a: i32, b: i32) -> i32 {
        let result;
        // SAFETY: as above, with one more; no flag, no memory.
        unsafe {
            asm!("smmlar {}, {}, {}, {}", lateout(reg) result, in(reg) a, in(reg) b, in(reg) sum, options(nomem, nostack, preserves_flags));
        }
        result
    }

    #[inline(always)]
    fn subtract_high(sum: i32, a: i32, b: i32) -> i32 {
        let result;
        // SAFETY: as above.
        unsafe {
            asm!("smmlsr {}, {}, {}, {}", lateout(reg) result, in(reg) a, in(reg) b, in(reg) sum, options(nomem, nostack, preserves_flags));
        }
        result
    }
}
