//! The one operation everything here is made of: a product's upper half, rounded, on top of a sum.

/// How the upper half of a 64-bit product is taken and added up.
///
/// Rounded to nearest, halves up, as the Cortex-M4 does it (ARMv7-M manual, SMMULR, SMMLAR, SMMLSR).
/// What does not fit 32 bits wraps: whoever calls keeps the values within their ranges.
///
/// A trait, because a compiler does not always find the instructions by itself, and this library writes
/// no assembly language. Both forms give the same bits for any input.
pub trait Multiply: Copy + Eq {
    /// round(a b / 2³²).
    #[inline(always)]
    fn high(a: i32, b: i32) -> i32 {
        ((i64::from(a) * i64::from(b) + HALF) >> 32) as i32
    }

    /// sum + a b, all 64 bits of it (SMLAL).
    #[inline(always)]
    fn add_wide(sum: i64, a: i32, b: i32) -> i64 {
        sum.wrapping_add(i64::from(a) * i64::from(b))
    }

    /// round(sum + a b / 2³²).
    fn add_high(sum: i32, a: i32, b: i32) -> i32;

    /// round(sum − a b / 2³²).
    fn subtract_high(sum: i32, a: i32, b: i32) -> i32;
}

const HALF: i64 = 1 << 31;

/// In plain Rust, on any machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Portable;

impl Multiply for Portable {
    #[inline(always)]
    fn add_high(sum: i32, a: i32, b: i32) -> i32 {
        sum.wrapping_add(Self::high(a, b))
    }

    #[inline(always)]
    fn subtract_high(sum: i32, a: i32, b: i32) -> i32 {
        let product = i64::from(a) * i64::from(b);
        // |HALF − product| stays below 2⁶³, and a shift rounds down.
        sum.wrapping_add(((HALF - product) >> 32) as i32)
    }
}
