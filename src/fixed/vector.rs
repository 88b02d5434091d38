//! Three numbers of one format.

use super::multiply::Multiply;
use super::number::Q;

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

    /// The sum of the squares.
    #[inline(always)]
    pub fn norm_squared<const SUM: u32>(self) -> Q<M, SUM> {
        Q::product(self.x, self.x)
            .plus(self.y, self.y)
            .plus(self.z, self.z)
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
}
