//! Turns about the vertical.

use super::division::reciprocal_length;
use super::multiply::Multiply;
use super::number::{Q, Wide};

/// Cosine and sine of half the angle: a quaternion without x and z, of 62 fraction bits like
/// [`Quaternion`](super::quaternion::Quaternion).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn<M> {
    c: Wide<M, 62>,
    s: Wide<M, 62>,
}

impl<M: Multiply> Turn<M> {
    /// No turn.
    pub const NONE: Self = Self {
        c: Wide::from_bits(1 << 62),
        s: Wide::from_bits(0),
    };

    /// From cosine and sine of half the angle.
    pub fn from_halves([c, s]: [Q<M, 30>; 2]) -> Self {
        Self {
            c: Wide::from_upper(c),
            s: Wide::from_upper(s),
        }
    }

    /// Cosine and sine of half the angle, rounded down.
    #[inline(always)]
    pub fn halves(self) -> [Q<M, 30>; 2] {
        [self.c.upper(), self.s.upper()]
    }

    /// Cosine and sine of the angle.
    #[inline(always)]
    pub fn cos_and_sin(self) -> [Q<M, 28>; 2] {
        let [c, s] = self.halves();
        let half_sin = Q::<M, 28>::product(c, s);
        [Q::product(c, c).minus(s, s), half_sin + half_sin]
    }

    /// (1, t) after it, t up to ½: a turn by 2 arctan t, and of unit length.
    #[inline(always)]
    pub fn turned(self, t: Q<M, 32>) -> Self {
        let [c, s] = self.halves();
        let turned = Self {
            c: self.c.plus(s, -t),
            s: self.s.plus(c, t),
        };
        let excess = turned.excess();
        let small = const { Q::<M, 28>::constant(1.0 / 16384.0).bits() };
        if (-small..small).contains(&excess.bits()) {
            // (1 + e)^−½ = 1 − e/2 + 3e²/8 − …, of which the last is below 2e-9.
            return turned.grown(-excess.read_as::<29>().finer());
        }
        turned.normalised_anywhere(excess)
    }

    /// c² + s² − 1.
    #[inline(always)]
    fn excess(self) -> Q<M, 28> {
        let [c, s] = self.halves();
        let excess = Wide::<M, 60>::from_bits((1 << 31) - (1 << 60));
        excess.plus(c, c).plus(s, s).upper()
    }

    #[inline(always)]
    fn grown(self, share: Q<M, 32>) -> Self {
        let [c, s] = self.halves();
        Self {
            c: self.c.plus(c, share),
            s: self.s.plus(s, share),
        }
    }

    #[cold]
    #[inline(never)]
    fn normalised_anywhere(self, excess: Q<M, 28>) -> Self {
        let Some(length) = reciprocal_length(excess) else {
            return Self::NONE;
        };
        let [c, s] = self.halves();
        let whole = |q: Q<M, 30>| Wide::from_bits(q.wide(length) << 3);
        Self {
            c: whole(c),
            s: whole(s),
        }
    }

    /// This after another.
    pub fn after(self, first: Self) -> Self {
        let ([c, s], [d, t]) = (self.halves(), first.halves());
        // Q60 as Q62.
        let whole = |q60: i64| Wide::from_bits(q60 << 2);
        Self {
            c: whole(c.wide(d) - s.wide(t)),
            s: whole(s.wide(d) + c.wide(t)),
        }
    }
}
