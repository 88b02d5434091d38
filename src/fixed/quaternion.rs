//! Orientations: unit quaternions of 62 fraction bits, the upper 30 of which are reckoned with.
//!
//! The lower half is what a sample adds beyond them. Rounding it off would be off by as much again and again
//! wherever the same few counts come again and again: a sensor at rest.

use super::arc::{cosine, sine_per_angle};
use super::division::{reciprocal_length, shortening};
use super::multiply::Multiply;
use super::number::{Q, Wide};
use super::vector::Vector;

/// w, x, y, z.
///
/// The parts of a sum stand in the order in which fewest values wait: with one instruction for each product, the
/// compiler keeps it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quaternion<M> {
    w: Wide<M, 62>,
    x: Wide<M, 62>,
    y: Wide<M, 62>,
    z: Wide<M, 62>,
}

/// A turn about a horizontal axis: (cos, −sin z, 0, sin x) with the horizontal direction (x, z) that it
/// brings up.
#[derive(Clone, Copy, Debug)]
pub struct Levelling<M> {
    /// cos φ/2.
    pub cos: Q<M, 30>,
    /// x sin φ/2.
    pub x: Q<M, 30>,
    /// z sin φ/2.
    pub z: Q<M, 30>,
}

impl<M: Multiply> Quaternion<M> {
    /// No turn.
    pub const IDENTITY: Self = Self {
        w: Wide::from_bits(1 << 62),
        x: Wide::from_bits(0),
        y: Wide::from_bits(0),
        z: Wide::from_bits(0),
    };

    /// From w, x, y and z.
    #[inline]
    pub fn from_upper(parts: [Q<M, 30>; 4]) -> Self {
        let [w, x, y, z] = parts.map(Wide::from_upper);
        Self { w, x, y, z }
    }

    /// w, x, y and z, rounded down.
    #[inline(always)]
    pub fn upper(self) -> [Q<M, 30>; 4] {
        [
            self.w.upper(),
            self.x.upper(),
            self.y.upper(),
            self.z.upper(),
        ]
    }

    /// q (1, t): a turn in the body's own axes; √(1 + t²) times as long.
    #[inline(always)]
    pub fn turned_in_body(self, t: Vector<M, 32>) -> Self {
        let [w, x, y, z] = self.upper();
        Self {
            z: self.z.plus(w, t.z).plus(x, t.y).plus(y, -t.x),
            y: self.y.plus(w, t.y).plus(z, t.x).plus(x, -t.z),
            x: self.x.plus(w, t.x).plus(y, t.z).plus(z, -t.y),
            w: self.w.plus(x, -t.x).plus(y, -t.y).plus(z, -t.z),
        }
    }

    /// q (1 + c, s): a turn in the body's own axes by twice the angle of which s is the sine and 1 + c the cosine.
    #[inline(always)]
    pub fn rotated_in_body(self, c: Q<M, 32>, s: Vector<M, 32>) -> Self {
        // Not by way of `turned_in_body`: part by part, fewer values wait.
        let [w, x, y, z] = self.upper();
        Self {
            w: self.w.plus(x, -s.x).plus(y, -s.y).plus(z, -s.z).plus(w, c),
            x: self.x.plus(w, s.x).plus(y, s.z).plus(z, -s.y).plus(x, c),
            y: self.y.plus(w, s.y).plus(z, s.x).plus(x, -s.z).plus(y, c),
            z: self.z.plus(w, s.z).plus(x, s.y).plus(y, -s.x).plus(z, c),
        }
    }

    /// (1, −t_z, 0, t_x) q: a turn about a horizontal axis of the world, √(1 + t²) times as long.
    #[inline(always)]
    pub fn levelled_a_little(self, t_x: Q<M, 32>, t_z: Q<M, 32>) -> Self {
        let [w, x, y, z] = self.upper();
        Self {
            w: self.w.plus(x, t_z).plus(z, -t_x),
            y: self.y.plus(x, t_x).plus(z, t_z),
            x: self.x.plus(w, -t_z).plus(y, -t_x),
            z: self.z.plus(w, t_x).plus(y, -t_z),
        }
    }

    /// The same for any angle.
    #[inline]
    pub fn levelled(self, turn: Levelling<M>) -> Self {
        let [w, x, y, z] = self.upper();
        let Levelling {
            cos,
            x: s_x,
            z: s_z,
        } = turn;
        // What is added, as Q60: a factor of one would be for the whole, not for its upper half.
        let c = cos - const { Q::constant(1.0) };
        let and = |whole: Wide<M, 62>, q60: i64| Wide::from_bits(whole.bits() + (q60 << 2));
        Self {
            w: and(self.w, c.wide(w) + s_z.wide(x) - s_x.wide(z)),
            x: and(self.x, c.wide(x) - s_z.wide(w) - s_x.wide(y)),
            y: and(self.y, c.wide(y) + s_x.wide(x) + s_z.wide(z)),
            z: and(self.z, c.wide(z) + s_x.wide(w) - s_z.wide(y)),
        }
    }

    /// q a q⁻¹ |q|²: a vector of the body as seen from the world. 15 fraction bits and |q|² in, 11
    /// out. Half of what 32 bits hold goes in.
    ///
    /// |q|² a + 2 v × (v × a + w a) with the vector part v: what is in the brackets is no longer than a.
    #[inline(always)]
    pub fn in_world_times_square(self, a: Vector<M, 15>, norm_squared: Q<M, 27>) -> Vector<M, 11> {
        let [w, x, y, z] = self.upper();
        let a: Vector<M, 16> = a.finer();
        let inner: Vector<M, 14> = Vector {
            x: Q::product(w, a.x).plus(y, a.z).minus(z, a.y),
            y: Q::product(w, a.y).plus(z, a.x).minus(x, a.z),
            z: Q::product(w, a.z).plus(x, a.y).minus(y, a.x),
        };
        let outer: Vector<M, 11> = a.times(norm_squared);
        let (x, y, z): (Q<M, 29>, Q<M, 29>, Q<M, 29>) = (x.twice(), y.twice(), z.twice());
        Vector {
            x: outer.x.plus(y, inner.z).minus(z, inner.y),
            z: outer.z.plus(x, inner.y).minus(y, inner.x),
            y: outer.y.plus(z, inner.x).minus(x, inner.z),
        }
    }

    /// q a q⁻¹: a vector of the body as seen from the world. 15 fraction bits in, 12 out.
    #[inline(always)]
    pub fn in_world(self, a: Vector<M, 15>) -> Vector<M, 12> {
        let [w, x, y, z] = self.upper();
        let inner: Vector<M, 15> = Vector::<M, 13>::new(
            Q::product(w, a.x).plus(y, a.z).minus(z, a.y),
            Q::product(w, a.y).plus(z, a.x).minus(x, a.z),
            Q::product(w, a.z).plus(x, a.y).minus(y, a.x),
        )
        .finer();
        let outer: Vector<M, 12> = a.coarser();
        let (x, y, z): (Q<M, 29>, Q<M, 29>, Q<M, 29>) = (x.twice(), y.twice(), z.twice());
        Vector {
            x: outer.x.plus(y, inner.z).minus(z, inner.y),
            y: outer.y.plus(z, inner.x).minus(x, inner.z),
            z: outer.z.plus(x, inner.y).minus(y, inner.x),
        }
    }

    /// The world's x as the body sees it: the first row of the rotation matrix.
    #[inline(always)]
    pub fn world_x(self) -> Vector<M, 27> {
        let [w, x, y, z] = self.upper();
        Vector::<M, 28>::new(
            const { Q::constant(0.5) }.minus(y, y).minus(z, z),
            Q::product(x, y).minus(w, z),
            Q::product(x, z).plus(w, y),
        )
        .read_as()
    }

    /// The world's y, the vertical, as the body sees it: the second.
    #[inline(always)]
    pub fn world_y(self) -> Vector<M, 27> {
        let [w, x, y, z] = self.upper();
        Vector::<M, 28>::new(
            Q::product(x, y).plus(w, z),
            const { Q::constant(0.5) }.minus(x, x).minus(z, z),
            Q::product(y, z).minus(w, x),
        )
        .read_as()
    }

    /// The world's z as the body sees it: the third.
    #[inline(always)]
    pub fn world_z(self) -> Vector<M, 27> {
        let [w, x, y, z] = self.upper();
        Vector::<M, 28>::new(
            Q::product(x, z).minus(w, y),
            Q::product(y, z).plus(w, x),
            const { Q::constant(0.5) }.minus(x, x).minus(y, y),
        )
        .read_as()
    }

    /// |q|² − 1.
    #[inline(always)]
    fn excess(self) -> Q<M, 28> {
        let [w, x, y, z] = self.upper();
        // With half of the last bit that is kept.
        let excess = Wide::<M, 60>::from_bits((1 << 31) - (1 << 60));
        excess.plus(w, w).plus(x, x).plus(y, y).plus(z, z).upper()
    }

    /// q / |q|, within 7e-9 of unit length, if |q|² is from 1/1024 below 1 to 1/512 above.
    #[inline(always)]
    pub fn normalised_nearby(self) -> Option<Self> {
        let excess = self.excess();
        let (least, most) = const {
            let thousandth = Q::<M, 28>::constant(1.0 / 1024.0).bits();
            (-thousandth, 2 * thousandth)
        };
        (least..most).contains(&excess.bits()).then(|| {
            // (1 + e)^−½ − 1 = −e/2 + 3e²/8 − …: the next term is below 2.4e-9.
            let e: Q<M, 33> = excess.finer();
            let (half, next) = const { (Q::<M, 31>::constant(-0.5), Q::<M, 30>::constant(0.375)) };
            self.grown(Q::product(e, half.plus(e, next)))
        })
    }

    /// q / |q| for |q|² from ¾ to below 1¼: what is left of a quarter is 1e-3, then 1e-13.
    #[inline]
    pub fn normalised(self) -> Self {
        let nearly = self.shortened(self.excess().finer());
        nearly.shortened(nearly.excess().finer())
    }

    /// The same for |q|² from ¼ to below 4; none for any other.
    #[inline]
    pub fn normalised_anywhere(self) -> Option<Self> {
        let length = reciprocal_length(self.excess())?;
        let [w, x, y, z] = self.upper();
        // Q30 times Q29, as Q62.
        let whole = |q: Q<M, 30>| Wide::from_bits(q.wide(length) << 3);
        Some(Self {
            w: whole(w),
            x: whole(x),
            y: whole(y),
            z: whole(z),
        })
    }

    /// q (1 + e)^−½.
    #[inline(always)]
    fn shortened(self, e: Q<M, 33>) -> Self {
        self.grown(shortening(e))
    }

    /// This and as much more of itself as `share` says.
    #[inline(always)]
    fn grown(self, share: Q<M, 32>) -> Self {
        let [w, x, y, z] = self.upper();
        Self {
            w: self.w.plus(w, share),
            x: self.x.plus(x, share),
            y: self.y.plus(y, share),
            z: self.z.plus(z, share),
        }
    }
}

/// The product of two quaternions.
pub fn product<M: Multiply>(a: [Q<M, 30>; 4], b: [Q<M, 30>; 4]) -> [Q<M, 30>; 4] {
    let ([w, x, y, z], [d, e, f, g]) = (a, b);
    // The sum of four Q60, rounded to Q30.
    let rounded = |q60: i64| Q::from_bits(((q60 + (1 << 29)) >> 30) as i32);
    [
        rounded(w.wide(d) - x.wide(e) - y.wide(f) - z.wide(g)),
        rounded(w.wide(e) + x.wide(d) + y.wide(g) - z.wide(f)),
        rounded(w.wide(f) - x.wide(g) + y.wide(d) + z.wide(e)),
        rounded(w.wide(g) + x.wide(f) - y.wide(e) + z.wide(d)),
    ]
}

/// The turn at this rate, in counts, by so much of half an angle per count; of any size.
pub fn step<M: Multiply>(rate: Vector<M, 15>, half_angle_per_count: Q<M, 45>) -> [Q<M, 30>; 4] {
    let half = |rate| Q::<M, 28>::product(rate, half_angle_per_count);
    // A quarter of it, for which the series are good, taken four times.
    let quarter = |rate| half(rate).read_as::<30>();
    let (x, y, z) = (quarter(rate.x), quarter(rate.y), quarter(rate.z));
    let squared: Q<M, 29> = Q::<M, 28>::product(x, x).plus(y, y).plus(z, z).finer();
    let sine = sine_per_angle(squared);
    let along = |part| Q::<M, 28>::product(part, sine).finer::<30>();
    let first = [cosine(squared), along(x), along(y), along(z)];
    let twice = product(first, first);
    product(twice, twice)
}
