//! Tilt without drift from gyro and accelerometer; the heading is the gyro's.

use super::super::division::per;
use super::super::gyro::{Remainders, half_angle_per_count};
use super::super::half_angle::{cosine_excess, sine_excess};
use super::super::inclination::{Share, levelled};
use super::super::multiply::Multiply;
use super::super::number::{Q, Wide};
use super::super::quaternion::Quaternion;
use super::super::vector::Vector;
use super::parameters::{Rates, samples, seconds, weight};
use crate::fusion::Parameters;
use crate::fusion::parameters::{tilt_correction, tilt_low_pass_weight};
use core::num::NonZeroU32;

/// The complementary filter of second order.
#[derive(Clone, Copy, Debug)]
pub struct Inclination<M> {
    coefficients: Coefficients<M>,
    remainders: Remainders,
    orientation: Quaternion<M>,
    /// b, in counts of the accelerometer, as x and z of the force in the world: b = (−z, x).
    error: [Wide<M, 42>; 2],
    /// Samples since the start.
    age: u32,
}

/// What follows from the parameters and the sample period.
#[derive(Clone, Copy, Debug)]
struct Coefficients<M> {
    half_angle_per_count: Q<M, 49>,
    /// k_l: the low-pass of the error.
    low_pass: Q<M, 32>,
    /// ½ k_c per count: half of the share of it that is corrected in a sample.
    correction: Scaled<M>,
    /// 1 g.
    one_g: Q<M, 10>,
    /// From there to Q30, in g.
    shift_to_g: u32,
    start: u32,
    /// Age from which a sample needs nothing but [`Inclination::correct`]; never where a correction may be large.
    plain_from: u32,
}

/// A number as Q54 after a shift to the left.
#[derive(Clone, Copy, Debug)]
struct Scaled<M> {
    bits: Q<M, 54>,
    shift: u32,
}

impl<M: Multiply> Scaled<M> {
    fn new(value: f32) -> Self {
        let (mut value, mut shift) = (value, 0);
        while value >= (1.0 / (1 << 23) as f32) && shift < 16 {
            value *= 0.5;
            shift += 1;
        }
        Self {
            bits: Q::nearest(value),
            shift,
        }
    }

    #[inline(always)]
    fn times(self, counts: Q<M, 10>) -> Q<M, 32> {
        let product: Q<M, 32> = Q::product(counts, self.bits);
        Q::from_bits(product.bits() << self.shift)
    }
}

/// Most that is corrected in a sample of a force at the end of its range on each axis, as a half angle, rad: eight
/// such leave a quaternion that its format holds.
const LARGEST_CORRECTION: f32 = 0.2;

/// Where a correction may be larger than this, in a sample of a force at the end of its range on each axis, the length
/// is made good after each: a half angle, rad.
const SMALL_CORRECTION: f32 = 1.0 / 64.0;

/// Samples of the start whose corrections may be so large that each is followed by a root.
const LARGE: u32 = 64;

impl<M: Multiply> Coefficients<M> {
    fn new(parameters: &Parameters<f32>, rates: &Rates) -> Self {
        let period = seconds(rates.sample);
        let per_count = 0.5 * tilt_correction(parameters, period) / rates.counts_per_g();
        // 2¹¹ to 2¹⁴.
        let bits_per_g = (rates.counts_per_g() as u32).ilog2();
        // √3 · 2¹⁵ counts.
        const MOST_COUNTS: f32 = 56_756.0;
        let most = LARGEST_CORRECTION / MOST_COUNTS;
        let start = samples(parameters.start_time, rates.sample);
        let is_small = per_count * MOST_COUNTS <= SMALL_CORRECTION;
        Self {
            half_angle_per_count: half_angle_per_count(rates.ranges.gyro, rates.sample),
            low_pass: weight(tilt_low_pass_weight(parameters, period)),
            correction: Scaled::new(per_count.min(most)),
            one_g: Q::from_bits(1 << (bits_per_g + 10)),
            shift_to_g: 20 - bits_per_g,
            start,
            plain_from: if is_small { start } else { u32::MAX },
        }
    }
}

impl<M: Multiply> Inclination<M> {
    pub fn new(parameters: &Parameters<f32>, rates: &Rates) -> Self {
        Self {
            coefficients: Coefficients::new(parameters, rates),
            remainders: Remainders::START,
            orientation: Quaternion::IDENTITY,
            error: [Wide::from_bits(0); 2],
            age: 0,
        }
    }

    pub fn tune(&mut self, parameters: &Parameters<f32>, rates: &Rates) {
        self.coefficients = Coefficients::new(parameters, rates);
    }

    pub fn set_sample_period(&mut self, rates: &Rates) {
        self.coefficients.half_angle_per_count =
            half_angle_per_count(rates.ranges.gyro, rates.sample);
    }

    /// The first half of a sample, with the rate (counts, body frame, bias removed):
    ///
    /// 1. q_ω = q exp(ωΔt/2).
    #[inline(always)]
    pub fn turned(&mut self, rate: Vector<M, 15>) -> Quaternion<M> {
        let h: Vector<M, 32> = self
            .remainders
            .half_angle(rate, self.coefficients.half_angle_per_count);
        let h_squared = h.norm_squared();
        let sine = h.grown(sine_excess(h_squared));
        self.orientation
            .rotated_in_body(cosine_excess(h_squared), sine)
    }

    /// The second half, with the force (counts, body frame):
    ///
    /// 2. a ← q_ω f q_ω⁻¹, and its error e of x and z;
    /// 3. b ← b + k_l(e − b), and of that c = k_c b; in the first second c = e/n instead, and b is 0;
    /// 4. q ← (1, c/2) q_ω, which [`Self::normalise`] makes of unit length.
    #[inline(always)]
    pub fn correct(&mut self, q_omega: Quaternion<M>, force: Vector<M, 15>) {
        let [x, z] = lean(q_omega, force);
        let low_pass = self.coefficients.low_pass;
        let [b_x, b_z] = self.error;
        let (b_x, b_z) = (b_x.towards(x, low_pass), b_z.towards(z, low_pass));
        self.error = [b_x, b_z];
        let correction = self.coefficients.correction;
        let (c_x, c_z) = (correction.times(b_x.upper()), correction.times(b_z.upper()));
        self.orientation = q_omega.levelled_a_little(c_x, c_z);
    }

    /// The same in the first second.
    #[inline(always)]
    pub fn correct_at_the_start(&mut self, q_omega: Quaternion<M>, force: Vector<M, 15>) {
        self.age += 1;
        let share: Q<M, 31> = per(NonZeroU32::new(self.age).unwrap_or(NonZeroU32::MIN));
        let one_g = self.coefficients.one_g;
        let mut lean = lean(q_omega, force);
        // A knock in the first samples must not turn the picture over.
        if !(lean[0].is_within(one_g) && lean[1].is_within(one_g)) {
            lean = limited(lean, one_g);
        }
        let [c_x, c_z] = lean.map(|part| {
            let in_g = Q::<M, 30>::from_bits(part.bits() << self.coefficients.shift_to_g);
            Q::<M, 29>::product(in_g, share).read_as::<30>().finer()
        });
        self.orientation = q_omega.levelled_a_little(c_x, c_z);
        if self.age < LARGE {
            self.normalise();
        }
    }

    /// To unit length: once in a block, for what a small correction adds to the length is the square of it; with
    /// every sample where it may be large.
    #[inline(always)]
    pub fn normalise(&mut self) {
        match self.orientation.normalised_nearby() {
            Some(orientation) => self.orientation = orientation,
            None => self.normalise_anywhere(),
        }
    }

    #[cold]
    #[inline(never)]
    fn normalise_anywhere(&mut self) {
        // A length of ½ to 2 is never left in a block.
        if let Some(orientation) = self.orientation.normalised_anywhere() {
            self.orientation = orientation;
        }
    }

    /// Body to world, of a length that may be off by a millionth.
    #[inline(always)]
    pub fn orientation(&self) -> Quaternion<M> {
        self.orientation
    }

    /// The same of unit length.
    pub fn unit(&self) -> Quaternion<M> {
        let q = self.orientation;
        q.normalised_nearby()
            .or_else(|| q.normalised_anywhere())
            .unwrap_or(q)
    }

    /// b, counts, as x and z of the force in the world: how far from level the last seconds were.
    #[inline(always)]
    pub fn error(&self) -> [Q<M, 10>; 2] {
        self.error.map(Wide::upper)
    }

    /// Whether [`Self::correct`] is all that a sample needs.
    #[inline(always)]
    pub fn is_plain(&self) -> bool {
        self.age >= self.coefficients.plain_from
    }

    /// Whether the start is over, so that an error is the gyro's and not the start's.
    #[inline(always)]
    pub fn is_settled(&self) -> bool {
        self.age >= self.coefficients.start
    }

    /// Takes the tilt this force (counts, body frame) shows at once, keeps the heading, and forgets the error.
    pub fn level(&mut self, force: Vector<M, 15>) {
        let seen = self.orientation.in_world(force);
        self.orientation = levelled(self.orientation, seen, Share::WHOLE);
        self.error = [Wide::from_bits(0); 2];
        self.age = 0;
    }

    /// Goes on from here.
    pub fn set(&mut self, orientation: Quaternion<M>) {
        self.orientation = orientation;
        self.error = [Wide::from_bits(0); 2];
        self.age = self.coefficients.start;
    }
}

/// x and z of the force in the world.
#[inline(always)]
fn lean<M: Multiply>(q: Quaternion<M>, force: Vector<M, 15>) -> [Q<M, 10>; 2] {
    [q.world_x().dot(force), q.world_z().dot(force)]
}

#[cold]
#[inline(never)]
fn limited<M: Multiply>(lean: [Q<M, 10>; 2], limit: Q<M, 10>) -> [Q<M, 10>; 2] {
    lean.map(|part| part.limited(limit))
}
