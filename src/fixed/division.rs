//! Quotients and roots, by a rough first guess and Newton's steps. All take what has been shifted to
//! where its first bit is known: that is why none can divide by zero or overflow.

use super::multiply::Multiply;
use super::number::Q;
use core::num::NonZeroU32;

/// 1/y for y from 1 to below 2: above ½ to 1, and 1 itself fits. Good to 4e-9.
#[inline(always)]
pub fn reciprocal<M: Multiply>(y: Q<M, 30>) -> Q<M, 30> {
    // The upper 16 bits. y has bit 30, so the 1 changes nothing but what the compiler knows.
    let upper = NonZeroU32::new(y.bits() as u32 >> 15 | 1 << 15).unwrap_or(NonZeroU32::MAX);
    let guess = Q::<M, 30>::from_bits((((1 << 31) / upper) << 14) as i32);
    // At most 2⁻¹³ is missing, and the step leaves its square.
    let missing: Q<M, 32> = const { Q::<M, 28>::constant(1.0) }.minus(y, guess).finer();
    guess.plus(guess, missing)
}

/// 1/y for y from 1 to below 2: ½ to 1, and never 1 itself, for it is too little by up to 6e-9 of itself.
#[inline(always)]
pub fn reciprocal_from_below<M: Multiply>(y: Q<M, 30>) -> Q<M, 31> {
    let upper = NonZeroU32::new(y.bits() as u32 >> 15 | 1 << 15).unwrap_or(NonZeroU32::MAX);
    let guess = Q::<M, 31>::from_bits(((((1 << 31) - 1) / upper) << 15) as i32);
    let nearly_one = const { Q::<M, 29>::from_bits((1 << 29) - 1) };
    guess.plus(guess, nearly_one.minus(y, guess).finer::<32>())
}

/// 1/√y for y from ¼ to below 1: above 1 to 2, and 2 itself fits. Good to 6e-8.
#[inline]
pub fn reciprocal_root<M: Multiply>(y: Q<M, 31>) -> Q<M, 29> {
    // The line's error is at most 0.086 of it; every step leaves one and a half times its square.
    let y30 = Q::<M, 30>::from_bits(y.bits() >> 1);
    let slope: Q<M, 27> = Q::product(y30, const { Q::<M, 29>::constant(-1.2187) });
    let mut root = const { Q::<M, 29>::constant(2.1327) } + slope.finer();
    for _ in 0..3 {
        let square: Q<M, 28> = Q::<M, 26>::product(root, root).finer();
        let missing = const { Q::<M, 27>::constant(1.0) }.minus(square, y);
        // Half of it: read with one more fraction bit.
        let half: Q<M, 32> = Q::<M, 28>::from_bits(missing.bits()).finer();
        root = root.plus(root, half);
    }
    root
}

/// (1 + e)^−½ − 1 = −e/2 + 3e²/8 − 5e³/16 + …; leaves 35e⁴/128, 1e-9 for e = 1/128.
#[inline(always)]
pub fn shortening<M: Multiply>(e: Q<M, 33>) -> Q<M, 32> {
    let inner = const { Q::<M, 30>::constant(3.0 / 8.0) }
        .minus(e, const { Q::<M, 29>::constant(5.0 / 16.0) });
    let series = const { Q::<M, 31>::constant(-0.5) }.plus(e, inner);
    Q::product(e, series)
}

/// (1 + e)^−½ for 1 + e from ¼ to below 4, good to 2e-8; none for any other.
#[inline]
pub fn reciprocal_length<M: Multiply>(e: Q<M, 28>) -> Option<Q<M, 29>> {
    const ONE: i32 = 1 << 28;
    let square = e.bits().checked_add(ONE)?;
    match square {
        // A quarter of it as Q31, and half of its root's reciprocal.
        ONE..0x4000_0000 => {
            let twice = reciprocal_root(Q::<M, 31>::from_bits(square << 1));
            Some(Q::from_bits(twice.bits() >> 1))
        }
        0x400_0000..ONE => Some(reciprocal_root(Q::from_bits(square << 3))),
        _ => None,
    }
}

/// 1/n, but for n = 1 less by 2⁻²⁶, so that a product with one and a little more stays below one; and of 32
/// fraction bits just below ½ for n = 2 or less.
#[inline(always)]
pub fn per<M: Multiply, const BITS: u32>(n: NonZeroU32) -> Q<M, BITS> {
    const { assert!(BITS == 31 || BITS == 32) }
    let quotient = ((u32::MAX - 63) >> (32 - BITS)) / n;
    Q::from_bits(quotient.min(i32::MAX as u32) as i32)
}
