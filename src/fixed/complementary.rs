//! The filter of the course notes' eq. 24, from counts to a quaternion without floating point.
//!
//! What it computes is [`orientation::complementary`](crate::orientation::complementary), which is the one to read
//! first; here every step is put the way that costs least.

use super::gyro::{Remainders, half_angle_per_count};
use super::half_angle::{tangent_excess, tangent_squared};
use super::inclination::{HalfAnglePerTangent, Share, levelled, near_level};
use super::multiply::{Multiply, Portable};
use super::number::Q;
use super::quaternion::Quaternion;
use super::vector::Vector;
use crate::calibration::GyroBias;
use crate::orientation::TimeConstant;
use crate::sensor::{GyroRange, RawSample};
use crate::units::Seconds;

pub use super::gyro::Nanoseconds;

/// What a person chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// What the gyro was set to.
    pub gyro: GyroRange,
    /// At most 7.1 ms at ±2000 °/s and in proportion more at the others, 57 ms at ±250 °/s: a longer one is
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
    share: Share,
    /// Of a little share only.
    half_angle_per_tangent: Option<HalfAnglePerTangent<M>>,
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
            share,
            half_angle_per_tangent: match share {
                Share::Little(share) => Some(HalfAnglePerTangent::new(share)),
                Share::Much(_) => None,
            },
        }
    }
}

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
            derived: Derived::new(parameters),
            bias: Bias::ZERO,
            remainders: Remainders::START,
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
        let h = self.half_angle(sample.gyro);
        if let Some(orientation) = self.near_level(h, sample.accel) {
            self.orientation = orientation;
        } else {
            self.update_anywhere(sample);
        }
    }

    /// q_ω, and the force as it sees it.
    #[inline(always)]
    fn turned(&self, h: Vector<M, 32>, accel: [i16; 3]) -> (Quaternion<M>, Vector<M, 12>) {
        let h_squared = h.norm_squared();
        let excess = tangent_excess(h_squared);
        let q_omega = self.orientation.turned_in_body(h.grown(excess));
        let force = q_omega.in_world_times_square(
            Vector::from_counts(accel),
            tangent_squared(h_squared, excess),
        );
        (q_omega, force)
    }

    /// The sample as it nearly always is: a tilt error of at most 45°, α above 7/8, and a turn of a few degrees.
    #[inline(always)]
    fn near_level(&self, h: Vector<M, 32>, accel: [i16; 3]) -> Option<Quaternion<M>> {
        let half_angle_per_tangent = self.derived.half_angle_per_tangent.as_ref()?;
        let (q_omega, force) = self.turned(h, accel);
        let (x, z) = near_level(force, half_angle_per_tangent)?;
        q_omega.levelled_a_little(x, z).normalised_nearby()
    }

    /// Any sample, whose remainders are there already. From the start again: to put away what it has found would
    /// cost the common path its time.
    #[cold]
    #[inline(never)]
    fn update_anywhere(&mut self, sample: &RawSample) {
        let rates = self.rates(sample.gyro);
        self.remainders
            .take_back(rates, self.derived.half_angle_per_count);
        let h = self.half_angle(sample.gyro);
        let (q_omega, force) = self.turned(h, sample.accel);
        self.orientation = levelled(q_omega, force, self.derived.share);
    }

    /// In counts, with the bias off.
    #[inline(always)]
    fn rates(&self, gyro: [i16; 3]) -> Vector<M, 15> {
        let [x, y, z] = gyro;
        let Bias([bias_x, bias_y, bias_z]) = self.bias;
        let rate = |count: i16, bias: i32| Q::from_bits((i32::from(count) << 15) - bias);
        Vector::new(rate(x, bias_x), rate(y, bias_y), rate(z, bias_z))
    }

    /// n φ/2 of eq. 17, with the bias off. What is rounded off is carried over to the next sample.
    #[inline(always)]
    fn half_angle(&mut self, gyro: [i16; 3]) -> Vector<M, 32> {
        let rates = self.rates(gyro);
        self.remainders
            .half_angle(rates, self.derived.half_angle_per_count)
    }

    /// w, x, y, z of the orientation as of the last sample, body to world.
    pub fn orientation(&self) -> [f32; 4] {
        self.bits().map(|bits| bits as f32 / (1 << 30) as f32)
    }

    /// The same in units of 2⁻³⁰.
    pub fn bits(&self) -> [i32; 4] {
        self.orientation.upper().map(Q::bits)
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
        let force = self.orientation.in_world(Vector::from_counts(accel));
        self.orientation = levelled(self.orientation, force, Share::WHOLE);
    }
}
