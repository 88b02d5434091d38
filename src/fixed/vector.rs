//! Three numbers of one format.

use super::multiply::Multiply;
use super::number::{Q, Wide};
use core::ops::{Add, Sub};

/// A vector; its frame is what the name that holds it says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Vector<M, const BITS: u32> {
    /// Along x.
    pub x: Q<M, BITS>,
    /// Along y.
    pub y: Q<M, BITS>,
    /// Along z.
    pub z: Q<M, BITS>,
}

impl<M: Multiply, const BITS: u32> Vector<M, BITS> {
    /// From x, y and z.
    #[inline(always)]
    pub fn new(x: Q<M, BITS>, y: Q<M, BITS>, z: Q<M, BITS>) -> Self {
        Self { x, y, z }
    }

    /// Counts of the sensor, exactly.
    #[inline(always)]
    pub fn from_counts(counts: [i16; 3]) -> Self {
        const { assert!(BITS <= 16, "16 bits of a count are before the point") }
        // Not by way of `map`, which is a loop in an image built for size.
        let [x, y, z] = counts;
        let q = |count: i16| Q::from_bits(i32::from(count) << BITS);
        Self::new(q(x), q(y), q(z))
    }

    /// From the integers that stand for x, y and z.
    #[inline(always)]
    pub fn from_bits([x, y, z]: [i32; 3]) -> Self {
        Self::new(Q::from_bits(x), Q::from_bits(y), Q::from_bits(z))
    }

    /// x, y and z.
    #[inline(always)]
    pub fn parts(self) -> [Q<M, BITS>; 3] {
        [self.x, self.y, self.z]
    }

    /// Zero.
    pub const ZERO: Self = Self {
        x: Q::ZERO,
        y: Q::ZERO,
        z: Q::ZERO,
    };

    /// The sum of the squares, exactly, with the fraction bits of both factors.
    #[inline(always)]
    pub fn squared(self) -> u64 {
        // Three squares of 62 bits are more than a signed sum holds, and less than an unsigned one.
        let sum = M::add_wide(0, self.x.bits(), self.x.bits());
        let sum = M::add_wide(sum, self.y.bits(), self.y.bits());
        M::add_wide(sum, self.z.bits(), self.z.bits()) as u64
    }

    /// Whether no part is beyond −`limit` and `limit`, which is not negative.
    #[inline(always)]
    pub fn is_within(self, limit: Q<M, BITS>) -> bool {
        self.x.is_within(limit) && self.y.is_within(limit) && self.z.is_within(limit)
    }

    /// The sum of the squares.
    #[inline(always)]
    pub fn norm_squared<const SUM: u32>(self) -> Q<M, SUM> {
        Q::product(self.x, self.x)
            .plus(self.y, self.y)
            .plus(self.z, self.z)
    }

    /// The scalar product.
    #[inline(always)]
    pub fn dot<const B: u32, const OUT: u32>(self, other: Vector<M, B>) -> Q<M, OUT> {
        Q::product(self.x, other.x)
            .plus(self.y, other.y)
            .plus(self.z, other.z)
    }

    /// By this share of the way to `target`: one step of a low-pass of first order, rounded.
    #[inline(always)]
    pub fn towards(self, target: Self, share: Q<M, 32>) -> Self {
        let way = target - self;
        Self {
            x: self.x.plus(way.x, share),
            y: self.y.plus(way.y, share),
            z: self.z.plus(way.z, share),
        }
    }

    /// This and as much more of itself as `share` says.
    #[inline(always)]
    pub fn grown(self, share: Q<M, 32>) -> Self {
        Self {
            x: self.x.plus(self.x, share),
            y: self.y.plus(self.y, share),
            z: self.z.plus(self.z, share),
        }
    }

    /// So many times this.
    #[inline(always)]
    pub fn times<const FACTOR: u32, const PRODUCT: u32>(
        self,
        factor: Q<M, FACTOR>,
    ) -> Vector<M, PRODUCT> {
        Vector {
            x: Q::product(self.x, factor),
            y: Q::product(self.y, factor),
            z: Q::product(self.z, factor),
        }
    }

    /// The same in a finer format, in which it has to fit.
    #[inline(always)]
    pub fn finer<const FINER: u32>(self) -> Vector<M, FINER> {
        Vector {
            x: self.x.finer(),
            y: self.y.finer(),
            z: self.z.finer(),
        }
    }

    /// The same in a coarser format, rounded down.
    #[inline(always)]
    pub fn coarser<const COARSER: u32>(self) -> Vector<M, COARSER> {
        Vector {
            x: self.x.coarser(),
            y: self.y.coarser(),
            z: self.z.coarser(),
        }
    }

    /// The same bits, read with other fraction bits.
    #[inline(always)]
    pub fn read_as<const OTHER: u32>(self) -> Vector<M, OTHER> {
        Vector {
            x: self.x.read_as(),
            y: self.y.read_as(),
            z: self.z.read_as(),
        }
    }
}

impl<M: Multiply, const BITS: u32> Add for Vector<M, BITS> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<M: Multiply, const BITS: u32> Sub for Vector<M, BITS> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

/// The same with 64 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WideVector<M, const BITS: u32> {
    /// Along x.
    pub x: Wide<M, BITS>,
    /// Along y.
    pub y: Wide<M, BITS>,
    /// Along z.
    pub z: Wide<M, BITS>,
}

impl<M: Multiply, const BITS: u32> WideVector<M, BITS> {
    /// Zero.
    pub const ZERO: Self = Self {
        x: Wide::from_bits(0),
        y: Wide::from_bits(0),
        z: Wide::from_bits(0),
    };

    /// From the upper halves, each with half of its last bit.
    #[inline(always)]
    pub fn from_upper<const UPPER: u32>(upper: Vector<M, UPPER>) -> Self {
        Self {
            x: Wide::from_upper(upper.x),
            y: Wide::from_upper(upper.y),
            z: Wide::from_upper(upper.z),
        }
    }

    /// The upper halves, rounded down.
    #[inline(always)]
    pub fn upper<const UPPER: u32>(self) -> Vector<M, UPPER> {
        Vector::new(self.x.upper(), self.y.upper(), self.z.upper())
    }

    /// By this share of the way to `target`.
    #[inline(always)]
    pub fn towards<const UPPER: u32>(self, target: Vector<M, UPPER>, share: Q<M, 32>) -> Self {
        Self {
            x: self.x.towards(target.x, share),
            y: self.y.towards(target.y, share),
            z: self.z.towards(target.z, share),
        }
    }

    /// This and a b.
    #[inline(always)]
    pub fn plus<const A: u32, const B: u32>(self, a: Q<M, A>, b: Vector<M, B>) -> Self {
        Self {
            x: self.x.plus(a, b.x),
            y: self.y.plus(a, b.y),
            z: self.z.plus(a, b.z),
        }
    }
}
