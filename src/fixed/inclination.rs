//! Towards level by a share of the tilt (course notes, section 5.2 and eq. 24): what the force in the world says.
//!
//! The angle φ between the force and the vertical is arctan(√(x² + z²)/y), and the turn is about the
//! horizontal axis (−z, 0, x): neither depends on how long the force is.

use super::arc::{ARC_TANGENT_PER_RATIO, TANGENT_TERM, cosine, horner, sine_per_angle};
use super::division::{reciprocal, reciprocal_from_below, reciprocal_root};
use super::half_angle::tangent_excess;
use super::multiply::Multiply;
use super::number::Q;
use super::quaternion::{Levelling, Quaternion};
use super::vector::Vector;
use core::f64::consts::{FRAC_PI_2, PI};

/// (1 − α)/2, what a half angle is of the tilt: from 0 to ½, as Q35.
///
/// That many bits, because a long time constant at a high rate leaves few of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    /// Below 1/16, for α above 7/8: in 32 bits.
    Little(i32),
    /// More.
    Much(i64),
}

impl Share {
    /// As Q35.
    const HALF: i64 = 1 << 34;

    /// All of the tilt.
    pub const WHOLE: Self = Self::Much(Self::HALF);

    /// From 1 − α, the share of the accelerometer in one sample.
    pub fn from_accelerometer_weight(weight: f32) -> Self {
        // A cast saturates, and makes zero of what is not a number.
        let bits = ((weight * Self::HALF as f32) as i64).clamp(0, Self::HALF);
        i32::try_from(bits).map_or(Self::Much(bits), Self::Little)
    }
}

/// A levelling turn by less than 12°: (x, z) tan(φ s)/√(x² + z²) of a tilt φ and its share s.
pub type Little<M> = (Q<M, 32>, Q<M, 32>);

/// From tilts to levelling turns, near level.
#[derive(Clone, Copy, Debug)]
pub struct NearLevel<M> {
    /// tan(s φ)/tan φ: a polynomial in tan²φ − ½.
    gain: [Q<M, 35>; 7],
    /// What the upper half of up² − x² − z² has to be at least: more than it can be where the share is not little.
    margin: i32,
}

impl<M: Multiply> NearLevel<M> {
    /// For this share.
    pub fn new(share: Share) -> Self {
        let (share, margin) = match share {
            // 1 would be within what the squares are rounded by.
            Share::Little(share) => (i64::from(share), 2),
            Share::Much(_) => (0, 1 << 30),
        };
        // As Q38.
        let squared = (share * share) >> 32;
        let times_share = |[arc, term]: [i32; 2]| {
            let per_share = i64::from(arc) + ((i64::from(term) * squared) >> 38);
            Q::from_bits(((per_share * share + (1 << 29)) >> 30) as i32)
        };
        Self {
            gain: core::array::from_fn(|k| {
                times_share([ARC_TANGENT_PER_RATIO[k], TANGENT_TERM[k]])
            }),
            margin,
        }
    }

    /// For tilts up to 45°, but for 0.02° where the force is 1 g at ±16 g; none beyond, nor of a force of less
    /// than 50 counts.
    #[inline(always)]
    pub fn little(&self, force: Vector<M, 11>) -> Option<Little<M>> {
        let Vector { x, y: up, z } = force;
        let [x_bits, up_bits, z_bits] = [x, up, z].map(Q::bits);
        let room = M::subtract_high(M::high(up_bits, up_bits), x_bits, x_bits);
        let room = M::subtract_high(room, z_bits, z_bits);
        if up_bits <= 0 || room < self.margin {
            return None;
        }
        // Up becomes 1 to 2, and the others are less.
        let shift = up.bits().leading_zeros() - 1;
        let scaled = |q: Q<M, 11>| Q::<M, 30>::from_bits(q.bits() << shift);
        let per_up = reciprocal_from_below(scaled(up));
        let (x, z): (Q<M, 29>, Q<M, 29>) =
            (Q::product(scaled(x), per_up), Q::product(scaled(z), per_up));
        let tangent_squared_less_half: Q<M, 32> = const { Q::<M, 26>::constant(-0.5) }
            .plus(x, x)
            .plus(z, z)
            .finer();
        let gain = horner(tangent_squared_less_half, self.gain);
        Some((Q::product(x, gain), Q::product(z, gain)))
    }
}

/// φ (x, z)/√(x² + z²): the tilt, 0 to π, and which way.
#[derive(Clone, Copy, Debug)]
pub struct Tilt<M> {
    x: Q<M, 29>,
    z: Q<M, 29>,
}

/// Any tilt; none if the force is zero, which has no direction. One that points straight down
/// is turned up about x, as the notes leave open.
#[inline]
pub fn anywhere<M: Multiply>(force: Vector<M, 12>) -> Option<Tilt<M>> {
    let Vector { x, y: up, z } = force;
    let largest = x.bits().unsigned_abs() | up.bits().unsigned_abs() | z.bits().unsigned_abs();
    if largest == 0 {
        return None;
    }
    // The largest becomes ½ to 1.
    let shift = largest.leading_zeros().saturating_sub(2);
    let scaled = |q: Q<M, 12>| Q::<M, 30>::from_bits(q.bits() << shift);
    let (x, up, z) = (scaled(x), scaled(up), scaled(z));
    let Some((x, z, horizontal)) = horizontal(x, z) else {
        let straight_down = Tilt {
            x: Q::ZERO,
            z: const { Q::constant(-PI) },
        };
        return (up.bits() < 0).then_some(straight_down);
    };
    let phi = angle(horizontal, up);
    let along = |q: Q<M, 30>| Q::<M, 27>::product(phi, q).finer();
    Some(Tilt {
        x: along(x),
        z: along(z),
    })
}

impl<M: Multiply> Tilt<M> {
    /// A share of less than 1/16.
    #[inline]
    pub fn little(self, share: Q<M, 35>) -> Little<M> {
        let (x, z) = (Q::product(self.x, share), Q::product(self.z, share));
        let excess = tangent_excess(Q::<M, 32>::product(x, x).plus(z, z));
        (x.plus(x, excess), z.plus(z, excess))
    }

    /// Any share, as Q35.
    #[inline]
    pub fn much(self, share: i64) -> Levelling<M> {
        // Q27 times Q35 is at most π/2 as Q62.
        let half = |angle: Q<M, 29>| {
            let product = i64::from(angle.bits() >> 2) * share;
            Q::<M, 30>::from_bits(((product + (1 << 31)) >> 32) as i32)
        };
        let (x, z) = (half(self.x), half(self.z));
        let squared: Q<M, 29> = Q::<M, 28>::product(x, x).plus(z, z).finer();
        let sine = sine_per_angle(squared);
        Levelling {
            cos: cosine(squared),
            x: Q::<M, 28>::product(x, sine).finer(),
            z: Q::<M, 28>::product(z, sine).finer(),
        }
    }
}

/// The orientation levelled by a share of any tilt, which the force in the world shows, and normalised. Only the
/// force's direction matters: one of another format may be read as this.
#[inline]
pub fn levelled<M: Multiply>(
    q: Quaternion<M>,
    force: Vector<M, 12>,
    share: Share,
) -> Quaternion<M> {
    let levelled = match (anywhere(force), share) {
        (None, _) => q,
        (Some(tilt), Share::Little(share)) => {
            let (x, z) = tilt.little(Q::from_bits(share));
            q.levelled_a_little(x, z)
        }
        (Some(tilt), Share::Much(share)) => q.levelled(tilt.much(share)),
    };
    levelled.normalised()
}

/// (x, z) / √(x² + z²), and the root, for x and z up to ½; none if both are zero.
#[inline(always)]
pub fn horizontal<M: Multiply>(x: Q<M, 30>, z: Q<M, 30>) -> Option<(Q<M, 30>, Q<M, 30>, Q<M, 30>)> {
    let (x, z) = (x.bits(), z.bits());
    if x | z == 0 {
        return None;
    }
    // As many zeros as the larger has: inverting what is negative makes it shorter by one at most.
    let largest = (x ^ (x >> 31)) | (z ^ (z >> 31));
    // The larger becomes ½ to 1 of its own: beside a large vertical part both may be small.
    let shift = largest.leading_zeros().saturating_sub(2);
    let (x, z) = (x << shift, z << shift);
    let square = M::add_wide(M::add_wide(0, x, x), z, z);
    // From ¼ to below 1, by halving both if need be.
    let (x, z, square, halved) = if square >= 1 << 60 {
        (x >> 1, z >> 1, square >> 31, 1)
    } else {
        (x, z, square >> 29, 0)
    };
    let square = Q::<M, 31>::from_bits(square as i32);
    let per_root = reciprocal_root(square);
    let root: Q<M, 30> = Q::<M, 28>::product(square, per_root).finer();
    let unit = |part: i32| Q::<M, 27>::product(Q::<M, 30>::from_bits(part), per_root).finer();
    Some((
        unit(x),
        unit(z),
        Q::from_bits((root.bits() << halved) >> shift),
    ))
}

/// From the vertical: 0 to π. The larger of the two is at least ½.
#[inline]
fn angle<M: Multiply>(horizontal: Q<M, 30>, up: Q<M, 30>) -> Q<M, 29> {
    let vertical = Q::<M, 30>::from_bits(up.bits().abs());
    let steep = horizontal.bits() > vertical.bits();
    let (small, large) = if steep {
        (vertical, horizontal)
    } else {
        (horizontal, vertical)
    };
    let shift = large.bits().leading_zeros() - 1;
    let scaled = |q: Q<M, 30>| Q::<M, 30>::from_bits(q.bits() << shift);
    let ratio: Q<M, 30> = Q::<M, 28>::product(scaled(small), reciprocal(scaled(large))).finer();
    let squared_less_half = const { Q::<M, 28>::constant(-0.5) }.plus(ratio, ratio);
    // ½ itself is just too much.
    let squared_less_half = Q::<M, 28>::from_bits(squared_less_half.bits().min((1 << 27) - 1));
    let per_ratio = horner(
        squared_less_half.finer::<32>(),
        ARC_TANGENT_PER_RATIO.map(Q::<M, 30>::from_bits),
    );
    let arc: Q<M, 29> = Q::<M, 28>::product(ratio, per_ratio).finer();
    let (half_turn, right_angle) = const { (Q::constant(PI), Q::constant(FRAC_PI_2)) };
    match (steep, up.bits() >= 0) {
        (false, true) => arc,
        (true, true) => right_angle - arc,
        (true, false) => right_angle + arc,
        (false, false) => half_turn - arc,
    }
}
