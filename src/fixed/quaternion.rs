//! Orientations: unit quaternions of 62 fraction bits, the upper 30 of which are reckoned with.
//!
//! The lower half is what a sample adds beyond them. Rounding it off would be off by as much again and again
//! wherever the same few counts come again and again: a sensor at rest.

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
    pub fn from_upper(upper: [Q<M, 30>; 4]) -> Self {
        let [w, x, y, z] = upper.map(|q| Wide::from_bits(i64::from(q.bits()) << 32));
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

    /// q a q⁻¹ |q|²: a vector of the body as seen from the world. Counts and |q|² in; counts with 11 fraction
    /// bits out.
    ///
    /// |q|² a + 2 v × (v × a + w a) with the vector part v: what is in the brackets is no longer than a.
    #[inline(always)]
    pub fn in_world(self, counts: [i16; 3], norm_squared: Q<M, 27>) -> Vector<M, 11> {
        let [w, x, y, z] = self.upper();
        let a: Vector<M, 16> = Vector::from_counts(counts);
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

    /// q (1 + e)^−½ = q (1 − e/2 + 3e²/8 − 5e³/16 + …); leaves 35e⁴/128, 1e-9 for e = 1/128.
    #[inline(always)]
    fn shortened(self, e: Q<M, 33>) -> Self {
        let inner = const { Q::<M, 30>::constant(3.0 / 8.0) }
            .minus(e, const { Q::<M, 29>::constant(5.0 / 16.0) });
        let series = const { Q::<M, 31>::constant(-0.5) }.plus(e, inner);
        self.grown(Q::product(e, series))
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
