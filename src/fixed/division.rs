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

/// 1/√y for y from ¼ to below 1: above 1 to 2, and 2 itself fits. Good to 1e-8.
#[inline]
pub fn reciprocal_root<M: Multiply>(y: Q<M, 31>) -> Q<M, 29> {
    // The chord's error is below 0.14 of it; every step leaves one and a half times its square.
    let y30 = Q::<M, 30>::from_bits(y.bits() >> 1);
    let slope: Q<M, 27> = Q::product(y30, const { Q::<M, 29>::constant(-4.0 / 3.0) });
    let mut root = const { Q::<M, 29>::constant(2.2) } + slope.finer();
    for _ in 0..4 {
        let square: Q<M, 28> = Q::<M, 26>::product(root, root).finer();
        let missing = const { Q::<M, 27>::constant(1.0) }.minus(square, y);
        // Half of it: read with one more fraction bit.
        let half: Q<M, 32> = Q::<M, 28>::from_bits(missing.bits()).finer();
        root = root.plus(root, half);
    }
    root
}
