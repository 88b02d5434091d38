//! The filter of the course notes' eq. 24, from counts to a quaternion without floating point.
//!
//! What it computes is [`orientation::complementary`](crate::orientation::complementary), which is the one to read
//! first; here every step is put the way that costs least.

use super::gyro::{Remainders, half_angle_per_count};
use super::half_angle::{length_squared, tangent_excess};
use super::inclination::{NearLevel, Share, levelled};
use super::multiply::{Multiply, Portable};
use super::number::Q;
use super::quaternion::Quaternion;
use super::vector::Vector;
use crate::calibration::GyroBias;
use crate::orientation::TimeConstant;
use crate::sensor::{GyroRange, RawSample};
use crate::units::Seconds;

pub use super::gyro::Nanoseconds;
pub use super::measurement::Force;

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
        let per_dps = gyro.counts_per_dps() * 32768.0;
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
    fn new(parameters: &Parameters) -> Self {
        let Parameters {
            gyro,
            sample_period,
            time_constant,
        } = *parameters;
        let seconds = Seconds(sample_period.0 as f32 * 1e-9);
        let share = Share::from_accelerometer_weight(time_constant.accelerometer_weight(seconds));
        Self {
            half_angle_per_count: half_angle_per_count(gyro, sample_period),
            near_level: NearLevel::new(share),
            share,
        }
    }
}

/// The complementary filter on quaternions, eq. 24, in integers.
///
/// ```
/// use vrduino::fixed::complementary::{Complementary, Force, Nanoseconds, Parameters};
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
/// filter.reset(Force::from_counts(sample.accel));
/// for _ in 0..1000 {
///     filter.update(&sample);
/// }
/// let [w, _, y, _] = filter.orientation();
/// assert!((2.0 * y.atan2(w).to_degrees() - 90.0).abs() < 0.05);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Complementary<M = Portable> {
    gyro: GyroRange,
    derived: Derived<M>,
    bias: Bias,
    remainders: Remainders,
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
            gyro: parameters.gyro,
            derived: Derived::new(parameters),
            bias: Bias::ZERO,
            remainders: Remainders::START,
            orientation: Quaternion::IDENTITY,
        }
    }

    /// Goes on with other parameters.
    pub fn tune(&mut self, parameters: &Parameters) {
        self.gyro = parameters.gyro;
        self.derived = Derived::new(parameters);
    }

    /// The time between two samples as it was measured, which is what the gyro turns for. The accelerometer's share
    /// stays that of the nominal one.
    pub fn set_sample_period(&mut self, period: Nanoseconds) {
        self.derived.half_angle_per_count = half_angle_per_count(self.gyro, period);
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
        self.update_corrected(sample.gyro, Force::from_counts(sample.accel));
    }

    /// The same with the accelerometer corrected.
    #[inline(always)]
    pub fn update_corrected(&mut self, gyro: [i16; 3], force: Force) {
        let (tangent, h_squared) = self.half_angle(gyro);
        let q_omega = self.orientation.turned_in_body(tangent);
        let force = q_omega.in_world_times_square(force.vector(), length_squared(h_squared));
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
        self.orientation = levelled(
            self.orientation,
            Vector::new(x, y, z).read_as(),
            self.derived.share,
        );
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
        let tangent = self.remainders.half_angle(rate, tangent_per_count);
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

    /// Goes on from this orientation, body to world, in units of 2⁻³⁰. False, and nothing changes, if its length is not
    /// from ½ to 2.
    pub fn set(&mut self, orientation: [i32; 4]) -> bool {
        let q = Quaternion::from_upper(orientation.map(Q::from_bits));
        let Some(q) = q.normalised_anywhere() else {
            return false;
        };
        // Once more: a root in few steps is good to seven digits.
        self.orientation = q.normalised();
        true
    }

    /// Starts again with no turn about the vertical and the tilt this force (body frame) shows (section 5.2); from the
    /// identity if it shows none.
    pub fn reset(&mut self, force: Force) {
        self.orientation = Quaternion::IDENTITY;
        self.level(force);
    }

    /// Takes the tilt this force (body frame) shows at once and keeps yaw. One without direction changes nothing.
    pub fn level(&mut self, force: Force) {
        let one = const { Q::constant(1.0) };
        let force = self.orientation.in_world_times_square(force.vector(), one);
        self.orientation = levelled(self.orientation, force.read_as(), Share::WHOLE);
    }
}
