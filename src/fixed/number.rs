//! Numbers with a fixed number of fraction bits, which are in their type.

use super::multiply::Multiply;
use core::marker::PhantomData;
use core::ops::{Add, Neg, Sub};

/// `bits` · 2^−`BITS`, from −2^(31−`BITS`) to just below 2^(31−`BITS`); its products are taken by `M`.
///
/// Sums are exact as long as they stay in range, which is the caller's affair. A product is rounded to the
/// nearest bit once, and the format of the result follows from those of the factors: the compiler
/// refuses any other.
///
/// ```
/// use vrduino::fixed::{multiply::Portable, number::Q};
///
/// let half = Q::<Portable, 32>::constant(0.25);
/// let three = Q::<Portable, 28>::constant(3.0);
/// // 32 + 28 − 32 fraction bits.
/// let product: Q<Portable, 28> = Q::product(half, three);
/// assert_eq!(product, Q::constant(0.75));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Q<M, const BITS: u32> {
    bits: i32,
    multiply: PhantomData<M>,
}

impl<M: Multiply, const BITS: u32> Q<M, BITS> {
    /// Nothing.
    pub const ZERO: Self = Self::from_bits(0);

    /// From the integer that stands for it.
    #[inline(always)]
    pub const fn from_bits(bits: i32) -> Self {
        Self {
            bits,
            multiply: PhantomData,
        }
    }

    /// The integer that stands for it.
    #[inline(always)]
    pub const fn bits(self) -> i32 {
        self.bits
    }

    /// The nearest to `value`; the end of the range for what is outside. For constants: it computes in
    /// floating point.
    pub const fn constant(value: f64) -> Self {
        let mut scaled = value;
        let mut bit = 0;
        while bit < BITS {
            scaled *= 2.0;
            bit += 1;
        }
        // A cast cuts off towards zero, and saturates.
        let away = if scaled < 0.0 { -0.5 } else { 0.5 };
        Self::from_bits((scaled + away) as i32)
    }

    /// The nearest to `value`; the end of the range for what is outside, zero for what is not a number.
    /// For what follows from parameters: it computes in floating point.
    pub fn nearest(value: f32) -> Self {
        Self::from_bits(nearest(value * (1_u64 << BITS) as f32))
    }

    /// In floating point.
    pub fn to_f32(self) -> f32 {
        self.bits as f32 / (1_u64 << BITS) as f32
    }

    /// a b.
    #[inline(always)]
    pub fn product<const A: u32, const B: u32>(a: Q<M, A>, b: Q<M, B>) -> Self {
        const { assert!(A + B == BITS + 32, "a product has the bits of both less 32") }
        Self::from_bits(M::high(a.bits, b.bits))
    }

    /// This and a b.
    #[inline(always)]
    pub fn plus<const A: u32, const B: u32>(self, a: Q<M, A>, b: Q<M, B>) -> Self {
        const { assert!(A + B == BITS + 32, "a product has the bits of both less 32") }
        Self::from_bits(M::add_high(self.bits, a.bits, b.bits))
    }

    /// This less a b.
    #[inline(always)]
    pub fn minus<const A: u32, const B: u32>(self, a: Q<M, A>, b: Q<M, B>) -> Self {
        const { assert!(A + B == BITS + 32, "a product has the bits of both less 32") }
        Self::from_bits(M::subtract_high(self.bits, a.bits, b.bits))
    }

    /// The same value in a finer format, in which it has to fit.
    #[inline(always)]
    pub fn finer<const FINER: u32>(self) -> Q<M, FINER> {
        const { assert!(FINER >= BITS, "a finer format has more bits") }
        Q::from_bits(self.bits << (FINER - BITS))
    }

    /// Twice the value, with the same bits: one fraction bit less.
    #[inline(always)]
    pub fn twice<const LESS: u32>(self) -> Q<M, LESS> {
        const { assert!(LESS + 1 == BITS, "twice as much is one fraction bit less") }
        Q::from_bits(self.bits)
    }

    /// The same value in a coarser format, rounded down.
    #[inline(always)]
    pub fn coarser<const COARSER: u32>(self) -> Q<M, COARSER> {
        const { assert!(COARSER <= BITS, "a coarser format has fewer bits") }
        Q::from_bits(self.bits >> (BITS - COARSER))
    }

    /// The same bits, read with other fraction bits: the value times a power of two.
    #[inline(always)]
    pub fn read_as<const OTHER: u32>(self) -> Q<M, OTHER> {
        Q::from_bits(self.bits)
    }

    /// The nearest from −`limit` to `limit`, which is not negative.
    #[inline(always)]
    pub fn limited(self, limit: Self) -> Self {
        // Not `clamp`, which panics where the ends are not in order.
        Self::from_bits(self.bits.min(limit.bits).max(-limit.bits))
    }

    /// Whether it is not beyond −`limit` and `limit`, which is not negative.
    #[inline(always)]
    pub fn is_within(self, limit: Self) -> bool {
        // Moved up by the limit, what is within is no larger than twice that, and what is not wraps around.
        self.bits.wrapping_add(limit.bits) as u32 <= (limit.bits as u32).wrapping_mul(2)
    }

    /// The exact product, with the fraction bits of both.
    #[inline(always)]
    pub fn wide<const B: u32>(self, other: Q<M, B>) -> i64 {
        i64::from(self.bits) * i64::from(other.bits)
    }
}

impl<M: Multiply, const BITS: u32> Add for Q<M, BITS> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::from_bits(self.bits + other.bits)
    }
}

impl<M: Multiply, const BITS: u32> Sub for Q<M, BITS> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::from_bits(self.bits - other.bits)
    }
}

impl<M: Multiply, const BITS: u32> Neg for Q<M, BITS> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::from_bits(-self.bits)
    }
}

/// The same with 64 bits: a sum of products that nothing is rounded off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wide<M, const BITS: u32> {
    bits: i64,
    multiply: PhantomData<M>,
}

impl<M: Multiply, const BITS: u32> Wide<M, BITS> {
    /// From the integer that stands for it.
    #[inline(always)]
    pub const fn from_bits(bits: i64) -> Self {
        Self {
            bits,
            multiply: PhantomData,
        }
    }

    /// The integer that stands for it.
    #[inline(always)]
    pub const fn bits(self) -> i64 {
        self.bits
    }

    /// From the upper half, and half of its last bit: what is added from then on is rounded to nearest by
    /// rounding down.
    #[inline(always)]
    pub fn from_upper<const UPPER: u32>(upper: Q<M, UPPER>) -> Self {
        const { assert!(UPPER + 32 == BITS, "the upper half has 32 bits less") }
        Self::from_bits(i64::from(upper.bits) << 32 | 1 << 31)
    }

    /// By this share of the way to `target`: one step of a low-pass of first order, that nothing is rounded
    /// off but what lies below the last bit of the target.
    #[inline(always)]
    pub fn towards<const UPPER: u32>(self, target: Q<M, UPPER>, share: Q<M, 32>) -> Self {
        self.plus(target - self.upper(), share)
    }

    /// The upper half, rounded down.
    #[inline(always)]
    pub fn upper<const UPPER: u32>(self) -> Q<M, UPPER> {
        const { assert!(UPPER + 32 == BITS, "the upper half has 32 bits less") }
        Q::from_bits((self.bits >> 32) as i32)
    }

    /// What [`upper`](Self::upper) leaves.
    #[inline(always)]
    pub fn lower(self) -> u32 {
        self.bits as u32
    }

    /// This and a b.
    #[inline(always)]
    pub fn plus<const A: u32, const B: u32>(self, a: Q<M, A>, b: Q<M, B>) -> Self {
        const { assert!(A + B == BITS, "a whole product has the bits of both") }
        Self::from_bits(M::add_wide(self.bits, a.bits, b.bits))
    }
}

/// To the nearest whole number, halves away from zero. Once in an image, and not once for each format.
#[inline(never)]
fn nearest(value: f32) -> i32 {
    // A cast cuts off towards zero, saturates, and makes zero of what is not a number.
    let away = if value < 0.0 { -0.5 } else { 0.5 };
    (value + away) as i32
}
