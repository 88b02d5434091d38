//! The default estimator in integers, from counts to a quaternion without floating point.
//!
//! What it computes is [`crate::fusion`], which is the one to read first: the files are the same, and so are
//! the names. Here everything is in counts of the sensor, and what is rounded off is carried over wherever it would
//! add up. Counts have no values that would have to be refused.
//!
//! | limit | of | beyond it |
//! |---|---|---|
//! | 7.1 ms at ±2000 °/s, in proportion more at the others | sample period | is taken for it |
//! | 0.05 s at 1 kHz and ±16 g, in proportion less at the others | `tilt_time` times `damping` | is taken for it |
//! | 2 samples, or blocks of 8 | time of any low-pass | is taken for it |
//! | half the range | `largest_bias_dps` | is taken for it |
//! | 114 ms at ±2000 °/s, in proportion more at the others | `lead` | is taken for it |
//! | ±2¹⁵ µT | field | is taken for it |
//!
//! | quantity | format |
//! |---|---|
//! | gyro's bias, and low-passed rate and force, counts | Q47, its upper half Q15 |
//! | error of tilt, counts of the accelerometer | Q44, Q12 |
//! | the world's axes in the body | Q59, Q27 |
//! | what an error adds to the bias, counts | Q52, Q20 with the rest carried over |
//! | field in the world, µT | Q12; of the reference Q44 |
//! | turn to north | Q62, Q30 |

mod bias;
mod disturbance;
mod heading;
mod inclination;
mod integral;
mod parameters;
mod rest;

pub use super::gyro::Nanoseconds;
pub use super::measurement::{Field, Force};
pub use crate::fusion::{FieldVerdict, Motion, Parameters, Source};
pub use bias::Bias;
pub use parameters::Rates;

use super::multiply::{Multiply, Portable};
use super::number::Q;
use super::quaternion::{Quaternion, product, step};
use super::vector::Vector;
use crate::fusion::parameters::DECIMATION;
use crate::sensor::RawSample;
use crate::units::AngularRate;
use heading::Heading;
use inclination::Inclination;
use integral::Integral;
use rest::Rest;

/// The default estimator in integers.
///
/// ```
/// use vrduino::fixed::fusion::{Fusion, Nanoseconds, Parameters, Rates};
/// use vrduino::sensor::{AccelRange, GyroRange, Ranges, RawSample};
///
/// let mut fusion = Fusion::new(&Parameters::default(), Rates {
///     sample: Nanoseconds(1_000_000),
///     field: Nanoseconds(10_000_000),
///     ranges: Ranges { gyro: GyroRange::Dps2000, accel: AccelRange::G16 },
/// });
/// // A second of 90 °/s about the vertical, which is what 1475 counts come to.
/// let sample = RawSample { gyro: [0, 1475, 0], accel: [0, 2048, 0], temperature: 0, fresh: true };
/// for _ in 0..1000 {
///     fusion.update(&sample, None);
/// }
/// let [w, _, y, _] = fusion.orientation();
/// assert!((2.0 * y.atan2(w).to_degrees() - 90.0).abs() < 0.05);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Fusion<M = Portable> {
    rates: Rates,
    /// Half an angle at the lead's end per count, rad.
    lead: Q<M, 45>,
    inclination: Inclination<M>,
    rest: Rest<M>,
    bias: Bias<M>,
    integral: Integral<M>,
    heading: Heading<M>,
    /// The rate of the last sample, counts, without bias: the lead goes on with it.
    rate: Vector<M, 15>,
    /// Samples in the block that is under way.
    step: u32,
    started: bool,
}

impl Fusion<Portable> {
    /// Starts with the first sample, in plain Rust. See [`with`](Self::with).
    pub fn new(parameters: &Parameters<f32>, rates: Rates) -> Self {
        Self::with(parameters, rates)
    }
}

impl<M: Multiply> Fusion<M> {
    /// Starts with the first sample: level by its force, heading ahead. Products are taken by `M`.
    pub fn with(parameters: &Parameters<f32>, rates: Rates) -> Self {
        Self {
            rates,
            lead: lead(parameters, &rates),
            inclination: Inclination::new(parameters, &rates),
            rest: Rest::new(parameters, &rates),
            bias: Bias::new(parameters, &rates),
            integral: Integral::new(parameters, &rates),
            heading: Heading::new(parameters, &rates),
            rate: Vector::ZERO,
            step: 0,
            started: false,
        }
    }

    /// Goes on with other parameters from where it is.
    pub fn tune(&mut self, parameters: &Parameters<f32>) {
        self.lead = lead(parameters, &self.rates);
        self.inclination.tune(parameters, &self.rates);
        self.rest.tune(parameters, &self.rates);
        self.bias.tune(parameters, &self.rates);
        self.integral.tune(parameters, &self.rates);
        self.heading.tune(parameters, &self.rates);
    }

    /// The time between two samples as it was measured, which is what the gyro turns for. The filters go on
    /// with weights for the nominal one until they are tuned: a hundredth of a time constant.
    pub fn set_sample_period(&mut self, period: Nanoseconds) {
        self.rates.sample = period;
        self.inclination.set_sample_period(&self.rates);
    }

    /// One sample with the gyro's bias still in it, body frame; every so often with a field.
    #[inline(always)]
    pub fn update(&mut self, sample: &RawSample, field: Option<Field>) {
        let force = || Force::from_counts(sample.accel);
        self.update_with(sample.gyro, force, field);
    }

    /// The same with the accelerometer corrected.
    #[inline(always)]
    pub fn update_corrected(&mut self, gyro: [i16; 3], force: &Force, field: Option<Field>) {
        self.update_with(gyro, || *force, field);
    }

    /// The force is asked for when it is needed: there are not registers enough to keep it.
    #[inline(always)]
    fn update_with(&mut self, gyro: [i16; 3], force: impl Fn() -> Force, field: Option<Field>) {
        self.rest.add_rate(gyro);
        self.rate = Vector::from_counts(gyro) - self.bias.counts();
        if self.inclination.is_plain() {
            let turned = self.inclination.turned(self.rate);
            let force = force().vector();
            self.rest.add_force(force);
            self.inclination.correct(turned, force);
        } else {
            self.start(force);
        }
        if let Some(field) = field {
            self.update_heading(field);
        }
        self.step = (self.step + 1) % DECIMATION;
        match self.step {
            0 => self.look_at_rate(),
            1 if self.rest.has_looked() => self.look_at_force(),
            2 => self.settle(),
            3 if self.is_still() => self.follow_rest(),
            4 => self.follow_axes(),
            5 if !self.is_still() => self.follow_tilt(),
            _ => {}
        }
    }

    /// A sample of the first second, or one whose correction may be large; its rate is there already.
    #[inline(never)]
    fn start(&mut self, force: impl Fn() -> Force) {
        let force = force().vector();
        if !self.started {
            self.inclination.level(force);
            self.started = true;
        }
        self.rest.add_force(force);
        let turned = self.inclination.turned(self.rate);
        if self.inclination.is_settled() {
            self.inclination.correct(turned, force);
            self.inclination.normalise();
        } else {
            self.inclination.correct_at_the_start(turned, force);
        }
    }

    /// One field.
    #[inline(never)]
    fn update_heading(&mut self, field: Field) {
        let orientation = self.inclination.orientation();
        let field = orientation.in_world(field.vector());
        let Some(error) = self.heading.update(field, self.rate) else {
            return;
        };
        let source = self.bias.source();
        let axis = orientation.world_y();
        if let Some(error) = self.integral.of_heading(error, source)
            && !self.is_still()
        {
            self.bias.shift([(error, axis)]);
        }
    }

    /// At the last block: its rate.
    #[inline(never)]
    fn look_at_rate(&mut self) {
        self.rest.look_at_rate(self.bias.known());
    }

    /// And its force, with which there is a verdict.
    #[inline(never)]
    fn look_at_force(&mut self) {
        self.rest.look_at_force();
        if let Motion::Moving { .. } = self.rest.judge() {
            self.bias.moves();
        }
    }

    /// What may become a rest is kept; and this is when the orientation gets its length.
    #[inline(never)]
    fn settle(&mut self) {
        self.rest.settle();
        self.inclination.normalise();
    }

    /// What a rest means for the bias.
    #[inline(never)]
    fn follow_rest(&mut self) {
        if self.rest.begins() {
            let (rate, blocks) = self.rest.calm_rate();
            self.bias.begins_to_rest(rate, blocks);
        } else {
            self.bias.rests(self.rest.block_rate());
        }
    }

    #[inline(always)]
    fn is_still(&self) -> bool {
        matches!(self.motion(), Motion::Still { .. })
    }

    /// The axes along which an error of tilt is laid to the bias.
    #[inline(never)]
    fn follow_axes(&mut self) {
        self.integral.follow(&self.inclination);
    }

    /// What the tilt's error means for the bias; at rest the mean knows better.
    #[inline(never)]
    fn follow_tilt(&mut self) {
        if self.inclination.is_settled() {
            let source = self.bias.source();
            self.bias
                .shift(self.integral.of_tilt(self.inclination.error(), source));
        }
    }

    /// w, x, y, z of the orientation, body to world, led by [`Parameters::lead`]; the identity before the
    /// first sample.
    pub fn orientation(&self) -> [f32; 4] {
        self.bits().map(|bits| bits as f32 / (1 << 30) as f32)
    }

    /// The same in units of 2⁻³⁰.
    pub fn bits(&self) -> [i32; 4] {
        if self.lead == Q::ZERO {
            return self.estimate();
        }
        product(self.unled(), step(self.rate, self.lead)).map(Q::bits)
    }

    /// The same without a lead, as of the last sample.
    pub fn estimate(&self) -> [i32; 4] {
        self.unled().map(Q::bits)
    }

    fn unled(&self) -> [Q<M, 30>; 4] {
        let [c, s] = self.heading.turn().halves();
        let turn = [c, Q::ZERO, s, Q::ZERO];
        product(turn, self.inclination.unit().upper())
    }

    /// Takes the tilt this force (body frame) shows, and from now on looks straight ahead with the
    /// heading it has: heading 0, from which north is counted too. The bias is kept.
    pub fn reset(&mut self, force: Force) {
        self.inclination.level(force.vector());
        self.heading.look_ahead(self.inclination.orientation());
        self.started = true;
    }

    /// Goes on from this orientation, body to world, in units of 2⁻³⁰, with bias and compass as they are.
    /// False, and nothing changes, if its length is not from ½ to 2.
    pub fn set(&mut self, orientation: [i32; 4]) -> bool {
        let Some(orientation) =
            Quaternion::from_upper(orientation.map(Q::from_bits)).normalised_anywhere()
        else {
            return false;
        };
        let [c, s] = self.heading.turn().halves();
        let back = [c, Q::ZERO, -s, Q::ZERO];
        let inclined = product(back, orientation.upper());
        self.inclination.set(Quaternion::from_upper(inclined));
        self.started = true;
        true
    }

    /// Takes the tilt this force (body frame) shows at once and keeps the heading: after a gap.
    pub fn level(&mut self, force: Force) {
        self.inclination.level(force.vector());
        self.rest.restart();
        self.step = 0;
    }

    /// Takes this rate (body frame) for the gyro's bias, as one measured at rest. False, and nothing
    /// changes, if it is not finite or beyond [`Parameters::largest_bias_dps`].
    pub fn set_bias(&mut self, at_rest: AngularRate<f32>) -> bool {
        self.bias.set(at_rest)
    }

    /// Begins with this rate (body frame) as the gyro's bias, without believing that it was measured.
    /// False as in [`Self::set_bias`].
    pub fn guess_bias(&mut self, rate: AngularRate<f32>) -> bool {
        self.bias.guess(rate)
    }

    /// What the gyro reads when nothing turns, and how that is known.
    pub fn bias(&self) -> &Bias<M> {
        &self.bias
    }

    /// Still or moving, and for how long.
    #[inline(always)]
    pub fn motion(&self) -> Motion {
        self.rest.motion()
    }

    /// At rest: how fast the orientation still turns, that is the heading's drift, in the body's axes.
    /// None on the move, when nobody can tell.
    pub fn residual(&self) -> Option<AngularRate<f32>> {
        let residual = self.rest.mean_rate() - self.bias.counts();
        self.is_still().then(|| self.bias.physical(residual))
    }

    /// What the compass is worth at the moment.
    pub fn field_verdict(&self) -> FieldVerdict {
        self.heading.verdict()
    }
}

/// Half an angle at the lead's end per count: at most 114 ms at ±2000 °/s and in proportion more at the others.
fn lead<M: Multiply>(parameters: &Parameters<f32>, rates: &Rates) -> Q<M, 45> {
    Q::nearest(0.5 * parameters.lead.0.max(0.0) / rates.counts_per_rad_per_s())
}
