//! The filter of the course notes' eq. 24, from counts to a quaternion without floating point.
//!
//! What it computes is [`orientation::complementary`](crate::orientation::complementary), which is the one to read
//! first; here every step is put the way that costs least.

use super::half_angle::{length_squared, tangent_excess};
use super::inclination::{NearLevel, Share, anywhere};
use super::multiply::{Multiply, Portable};
use super::number::{Q, Wide};
use super::quaternion::Quaternion;
use super::vector::Vector;
use crate::calibration::GyroBias;
use crate::orientation::TimeConstant;
use crate::sensor::{GyroRange, RawSample};
use crate::units::{RADIANS_PER_DEGREE, Seconds};
use nalgebra::UnitQuaternion;

/// The time from one sample to the next in nanoseconds.
///
/// Single precision would keep seven digits of it, and a gyro that turned by 6000° would be off by a
/// thousandth of a degree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nanoseconds(pub u32);

/// What a person chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// What the gyro was set to.
    pub gyro: GyroRange,
    /// At most 6.7 ms at ±2000 °/s and in proportion more at the others, 53 ms at ±250 °/s: a longer one is
    /// taken for that.
    pub sample_period: Nanoseconds,
    /// τ, or α by way of [`TimeConstant::from_gyro_weight`].
    pub time_constant: TimeConstant<f32>,
}

/// What the gyro reads at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bias([i32; 3]);

impl Bias {
    /// Half the range: no sensor comes near, and whatever is corrected by it fits 32 bits.
    const LIMIT: i32 = 1 << 29;

    /// None.
    pub const ZERO: Self = Self([0; 3]);

    /// In 2⁻¹⁵ counts, body frame; at most half the range, as which more is taken.
    pub fn from_parts_of_counts(parts: [i32; 3]) -> Self {
        Self(parts.map(|part| part.clamp(-Self::LIMIT, Self::LIMIT)))
    }

    /// From physical units, at the range the gyro was set to. Zero for what is not a number.
    pub fn new(bias: GyroBias<f32>, gyro: GyroRange) -> Self {
        let per_dps = (f64::from(1 << 30) / gyro.max_dps()) as f32;
        let dps: [f32; 3] = bias.rate().dps().into();
        // A cast saturates.
        Self::from_parts_of_counts(dps.map(|dps| (dps * per_dps) as i32))
    }
}

/// What follows from the parameters.
#[derive(Clone, Copy, Debug)]
struct Derived<M> {
    /// Half the angle of one sample, in radians per count.
    half_angle_per_count: Q<M, 49>,
    near_level: NearLevel<M>,
    share: Share,
}

impl<M: Multiply> Derived<M> {
    /// A sixteenth less than what fits, for what a tangent is longer than its angle.
    const LONGEST: u64 = 15 << 27;

    fn new(parameters: &Parameters) -> Self {
        let Parameters {
            gyro,
            sample_period: Nanoseconds(nanoseconds),
            time_constant,
        } = *parameters;
        let per_nanosecond = half_angle_per_nanosecond(gyro);
        let half_angle = (per_nanosecond * u64::from(nanoseconds) + (1 << 22)) >> 23;
        let share = Share::from_accelerometer_weight(
            time_constant.accelerometer_weight(Seconds(nanoseconds as f32 * 1e-9)),
        );
        Self {
            half_angle_per_count: Q::from_bits(half_angle.min(Self::LONGEST) as i32),
            near_level: NearLevel::new(share),
            share,
        }
    }
}

/// Half a radian per second and count, as Q72 per nanosecond: ½ max_range / 2¹⁵ 10⁻⁹ 2⁷².
const fn half_angle_per_nanosecond(gyro: GyroRange) -> u64 {
    const PER_DPS: f64 = 0.5 * RADIANS_PER_DEGREE * 1e-9 * (1_u64 << 57) as f64;
    const fn of(dps: f64) -> u64 {
        (dps * PER_DPS + 0.5) as u64
    }
    match gyro {
        GyroRange::Dps250 => const { of(GyroRange::Dps250.max_dps()) },
        GyroRange::Dps500 => const { of(GyroRange::Dps500.max_dps()) },
        GyroRange::Dps1000 => const { of(GyroRange::Dps1000.max_dps()) },
        GyroRange::Dps2000 => const { of(GyroRange::Dps2000.max_dps()) },
    }
}

/// Half of the last bit kept.
const ROUNDING: u32 = 1 << 31;

/// The complementary filter on quaternions, eq. 24, in integers.
///
/// ```
/// use vrduino::fixed::complementary::{Complementary, Nanoseconds, Parameters};
/// use vrduino::orientation::DEFAULT_TIME_CONSTANT;
/// use vrduino::sensor::{GyroRange, RawSample};
///
/// let mut filter = Complementary::new(&Parameters {
///     gyro: GyroRange::Dps2000,
///     sample_period: Nanoseconds(1_000_000),
///     time_constant: DEFAULT_TIME_CONSTANT,
/// });
/// // A second of 90 °/s about the vertical, which is what 1475 counts come to.
/// let sample = RawSample { gyro: [0, 1475, 0], accel: [0, 16384, 0], temperature: 0, fresh: true };
/// filter.reset(sample.accel);
/// for _ in 0..1000 {
///     filter.update(&sample);
/// }
/// let [w, _, y, _] = filter.orientation();
/// assert!((2.0 * y.atan2(w).to_degrees() - 90.0).abs() < 0.05);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Complementary<M = Portable> {
    derived: Derived<M>,
    bias: Bias,
    /// What the half angles of the samples so far have left below the last bit of theirs, as Q64.
    remainders: [u32; 3],
    orientation: Quaternion<M>,
}

impl Complementary<Portable> {
    /// Starts from the identity, in plain Rust. See [`with`](Self::with).
    pub fn new(parameters: &Parameters) -> Self {
        Self::with(parameters)
    }
}

impl<M: Multiply> Complementary<M> {
    /// Starts from the identity and without a bias; products are taken by `M`.
    pub fn with(parameters: &Parameters) -> Self {
        Self {
            derived: Derived::new(parameters),
            bias: Bias::ZERO,
            remainders: [ROUNDING; 3],
            orientation: Quaternion::IDENTITY,
        }
    }

    /// Goes on with other parameters.
    pub fn tune(&mut self, parameters: &Parameters) {
        self.derived = Derived::new(parameters);
    }

    /// What is taken off the gyro from now on.
    pub fn set_bias(&mut self, bias: Bias) {
        self.bias = bias;
    }

    /// One sample. Eq. 24: q ← q((1 − α)φ, n/|n|) q_ω with q_ω = q q_Δ (eq. 18).
    ///
    /// Neither q_Δ nor the correction need have unit length before the end: a turn is no less a turn.
    /// A force of zero counts corrects nothing.
    #[inline(always)]
    pub fn update(&mut self, sample: &RawSample) {
        let (tangent, h_squared) = self.half_angle(sample.gyro);
        let q_omega = self.orientation.turned_in_body(tangent);
        let force = q_omega.in_world(sample.accel, length_squared(h_squared));
        let Some((x, z)) = self.derived.near_level.little(force) else {
            self.orientation = q_omega;
            return self.level_anywhere(force.x, force.y, force.z);
        };
        let q = q_omega.levelled_a_little(x, z);
        let Some(q) = q.normalised_nearby() else {
            self.orientation = q;
            return self.normalise();
        };
        self.orientation = q;
    }

    /// By the share of any tilt. The force is in the world, and in registers: a common path that keeps it in
    /// memory for this one is longer.
    #[cold]
    #[inline(never)]
    fn level_anywhere(&mut self, x: Q<M, 11>, y: Q<M, 11>, z: Q<M, 11>) {
        self.level_by(self.derived.share, Vector::new(x, y, z));
    }

    /// By a share of any tilt.
    #[inline]
    fn level_by(&mut self, share: Share, force: Vector<M, 11>) {
        let q = self.orientation;
        self.orientation = match (anywhere(force), share) {
            (None, _) => q,
            (Some(tilt), Share::Little(share)) => {
                let (x, z) = tilt.little(Q::from_bits(share));
                q.levelled_a_little(x, z)
            }
            (Some(tilt), Share::Much(share)) => q.levelled(tilt.much(share)),
        };
        self.normalise();
    }

    /// To unit length, also after a turn by many degrees.
    #[cold]
    #[inline(never)]
    fn normalise(&mut self) {
        self.orientation = self.orientation.normalised();
    }

    /// n tan(φ/2) of eq. 17, with the bias off, and (φ/2)². What is rounded off is carried over to the next
    /// sample: in an even turn it would be the same again and again.
    #[inline(always)]
    fn half_angle(&mut self, gyro: [i16; 3]) -> (Vector<M, 32>, Q<M, 32>) {
        let [x, y, z] = gyro;
        let Bias([bias_x, bias_y, bias_z]) = self.bias;
        let rate = |count: i16, bias: i32| Q::from_bits((i32::from(count) << 15) - bias);
        let rate: Vector<M, 15> = Vector::new(rate(x, bias_x), rate(y, bias_y), rate(z, bias_z));
        let per_count = self.derived.half_angle_per_count;
        let h: Vector<M, 32> = rate.times(per_count);
        let h_squared = h.norm_squared();
        let tangent_per_count = per_count.plus(per_count, tangent_excess(h_squared));
        let [rest_x, rest_y, rest_z] = &mut self.remainders;
        let of = |rate: Q<M, 15>, rest: &mut u32| {
            let rest_and = Wide::<M, 64>::from_bits(i64::from(*rest));
            let tangent = rest_and.plus(rate, tangent_per_count);
            *rest = tangent.lower();
            tangent.upper()
        };
        let tangent = Vector::new(of(rate.x, rest_x), of(rate.y, rest_y), of(rate.z, rest_z));
        (tangent, h_squared)
    }

    /// w, x, y, z of the orientation as of the last sample, body to world.
    pub fn orientation(&self) -> [f32; 4] {
        self.bits().map(|bits| bits as f32 / (1 << 30) as f32)
    }

    /// The same in units of 2⁻³⁰.
    pub fn bits(&self) -> [i32; 4] {
        self.orientation.upper().map(Q::bits)
    }

    /// Goes on from this orientation, body to world. One that is not a number, or no unit quaternion, changes nothing.
    pub fn set(&mut self, orientation: &UnitQuaternion<f32>) {
        let q = orientation.quaternion();
        if (q.norm_squared() - 1.0).abs() < 0.1 {
            let of = |part: f32| Q::from_bits((part * (1 << 30) as f32) as i32);
            self.orientation = Quaternion::from_upper([of(q.w), of(q.i), of(q.j), of(q.k)]);
            self.normalise();
        }
    }

    /// Starts again with no turn about the vertical and the tilt this force (counts, body frame) shows
    /// (section 5.2); from the identity if it shows none.
    pub fn reset(&mut self, accel: [i16; 3]) {
        self.orientation = Quaternion::IDENTITY;
        self.level(accel);
    }

    /// Takes the tilt this force (counts, body frame) shows at once and keeps yaw. One without direction changes
    /// nothing.
    pub fn level(&mut self, accel: [i16; 3]) {
        let force = self.orientation.in_world(accel, const { Q::constant(1.0) });
        self.level_by(Share::WHOLE, force);
    }
}
