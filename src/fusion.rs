//! The estimator that is streamed by default: a complementary filter of second order for tilt, the
//! gyro's bias kept up while it runs, and a heading by compass that corrects nothing but the heading.
//!
//! | file | does |
//! |---|---|
//! | `parameters` | what a person chooses, as times in seconds |
//! | `inclination` | gyro and accelerometer to a tilt without drift, heading from the gyro alone |
//! | `rest` | sees when nothing moves |
//! | `bias` | what the gyro reads when nothing turns: a mean at rest |
//! | `integral` | and on the move, what the errors of tilt and heading say of it |
//! | `disturbance` | tells the field of the earth from that of a magnet |
//! | `heading` | a turn about the vertical that brings north to north |
//!
//! Where the notes' filter ([`Complementary`]) turns the *direction* of the force towards up, this
//! one averages the force itself, in the world, over a few seconds: accelerations cancel over such a
//! time, but only if each has entered with its size. That is the idea of VQF (D. Laidig and
//! T. Seel, “VQF: Highly accurate IMU orientation estimation with bias estimation and magnetic
//! disturbance rejection”, Information Fusion 91, 2023) with two numbers of state in the place of a
//! filter in an inertial frame: once it has started, six axes take no root, no division and no
//! trigonometric function in a sample.
//!
//! World: y up, −z to magnetic north once a compass has had its say, −z ahead at the start without.
//!
//! [`Complementary`]: crate::orientation::complementary::Complementary

pub(crate) mod bias;
pub(crate) mod disturbance;
pub(crate) mod heading;
mod inclination;
pub(crate) mod integral;
pub(crate) mod parameters;
pub(crate) mod rest;

pub use bias::{Bias, Source};
pub use disturbance::FieldVerdict;
pub use parameters::{Parameters, Rates};
pub use rest::Motion;

use crate::orientation::gyro;
use crate::sensor::Sample;
use crate::units::{AngularRate, MagneticField, Seconds, SpecificForce};
use heading::Heading;
use inclination::Inclination;
use integral::Integral;
use nalgebra::{RealField, UnitQuaternion, Vector3, convert};
use parameters::DECIMATION;
use rest::Rest;

/// The default estimator. Generic over the scalar; what it does in `f64` is the definition that
/// other forms of it are held against.
#[derive(Clone, Debug)]
pub struct Fusion<T: RealField> {
    rates: Rates<T>,
    lead: Seconds<T>,
    inclination: Inclination<T>,
    rest: Rest<T>,
    bias: Bias<T>,
    integral: Integral<T>,
    heading: Heading<T>,
    /// The rate of the last sample, without bias: the lead goes on with it.
    rate: AngularRate<T>,
    /// Samples in the block that is under way. What is looked at once in a block is spread over its
    /// first samples, so that none takes long.
    step: u32,
    started: bool,
    refused: u32,
}

impl<T: RealField + Copy> Fusion<T> {
    /// Starts with the first sample: level by its force, heading ahead.
    pub fn new(parameters: &Parameters<T>, rates: Rates<T>) -> Self {
        Self {
            rates,
            lead: parameters.lead,
            inclination: Inclination::new(parameters, rates.sample),
            rest: Rest::new(parameters, rates.sample),
            bias: Bias::new(parameters, rates),
            integral: Integral::new(parameters, rates),
            heading: Heading::new(parameters, rates.field),
            rate: AngularRate::zero(),
            step: 0,
            started: false,
            refused: 0,
        }
    }

    /// Goes on with other parameters from where it is.
    pub fn tune(&mut self, parameters: &Parameters<T>) {
        self.lead = parameters.lead;
        self.inclination.tune(parameters, self.rates.sample);
        self.rest.tune(parameters, self.rates.sample);
        self.bias.tune(parameters, self.rates);
        self.integral.tune(parameters, self.rates);
        self.heading.tune(parameters, self.rates.field);
    }

    /// The time between two samples as it was measured, which is what the gyro turns for. The filters go
    /// on with weights for the nominal one until they are tuned: a hundredth of a time constant.
    pub fn set_sample_period(&mut self, period: Seconds<T>) {
        self.rates.sample = period;
        self.inclination.set_sample_period(period);
    }

    /// One sample with the gyro's bias still in it, body frame; every so often with a field,
    /// corrected for iron and in the body's axes.
    ///
    /// A sample that is not finite, or beyond what any sensor of this kind reports (200 rad/s,
    /// 1000 m/s²), is no measurement: the orientation stays as it is and [`Self::refused`] counts. A
    /// field that is none (zero, not finite, beyond 100 mT) leaves the heading to the gyro.
    pub fn update(&mut self, sample: &Sample<T>, field: Option<MagneticField<T>>) {
        let (rate, force) = (sample.rate.rad_per_s(), sample.force.m_per_s2());
        if !within(rate, 200.0) || !within(force, 1000.0) {
            self.refused = self.refused.saturating_add(1);
            return;
        }
        if !self.started {
            self.inclination.level(sample.force);
            self.started = true;
        }
        self.rate = AngularRate::from_rad_per_s(rate - self.bias.rad_per_s());
        self.inclination.update(self.rate, sample.force);
        self.rest.add(rate, force);
        if let Some(field) = field.map(MagneticField::microtesla)
            && within(field, 100_000.0)
        {
            self.update_heading(field);
        }
        self.step = (self.step + 1) % DECIMATION;
        match self.step {
            0 => self.rest.look_at_rate(self.bias.at_rest()),
            1 if self.rest.has_looked() => self.look_at_force(),
            2 => self.rest.settle(),
            3 if self.is_still() => self.follow_rest(),
            4 => self.integral.follow(&self.inclination),
            5 if !self.is_still() => self.follow_tilt(),
            _ => {}
        }
    }

    /// With the force there is a verdict on the last block.
    fn look_at_force(&mut self) {
        self.rest.look_at_force();
        if let Motion::Moving { .. } = self.rest.judge() {
            self.bias.moves();
        }
    }

    /// One field, µT, body frame.
    fn update_heading(&mut self, field: Vector3<T>) {
        let field = self.inclination.in_world(field);
        let Some(error) = self.heading.update(field, self.rate.rad_per_s()) else {
            return;
        };
        let source = self.bias.source();
        if let Some(shift) = self.integral.of_heading(&self.inclination, error, source)
            && !self.is_still()
        {
            self.bias.shift(shift);
        }
    }

    /// What a rest means for the bias.
    fn follow_rest(&mut self) {
        if self.rest.begins() {
            let (rate, blocks) = self.rest.calm_rate();
            self.bias.begins_to_rest(rate, blocks);
        } else {
            self.bias.rests(self.rest.block_rate());
        }
    }

    fn is_still(&self) -> bool {
        matches!(self.motion(), Motion::Still { .. })
    }

    /// What the tilt's error means for it; at rest the mean knows better.
    fn follow_tilt(&mut self) {
        let (error, source) = (self.inclination.error(), self.bias.source());
        if self.inclination.is_settled()
            && let Some(shift) = self.integral.of_tilt(error, source)
        {
            self.bias.shift(shift);
        }
    }

    /// Body to world, led by [`Parameters::lead`]; the identity before the first sample.
    pub fn orientation(&self) -> UnitQuaternion<T> {
        let q = self.estimate();
        if self.lead.0.is_zero() {
            return q;
        }
        q * gyro::step(self.rate, self.lead)
    }

    /// The same without a lead, as of the last sample.
    pub fn estimate(&self) -> UnitQuaternion<T> {
        self.heading.turn() * self.inclination.orientation()
    }

    /// Takes the tilt this force (body frame) shows, and from now on looks straight ahead with the
    /// heading it has: heading 0, from which north is counted too. The bias is kept.
    pub fn reset(&mut self, force: SpecificForce<T>) {
        self.inclination.level(force);
        self.heading.look_ahead(&self.inclination.orientation());
        self.started = true;
    }

    /// Goes on from this orientation, body to world, with bias and compass as they are.
    pub fn set(&mut self, orientation: UnitQuaternion<T>) {
        self.inclination
            .set(self.heading.turn().inverse() * orientation);
        self.started = true;
    }

    /// Takes the tilt this force (body frame) shows at once and keeps the heading: after a gap.
    pub fn level(&mut self, force: SpecificForce<T>) {
        self.inclination.level(force);
        self.rest.restart();
        self.step = 0;
    }

    /// Takes this rate (body frame) for the gyro's bias, as one measured at rest. False, and nothing
    /// changes, if it is not finite or beyond [`Parameters::largest_bias_dps`].
    pub fn set_bias(&mut self, at_rest: AngularRate<T>) -> bool {
        self.bias.set(at_rest)
    }

    /// Begins with this rate (body frame) as the gyro's bias, without believing that it was measured.
    /// False as in [`Self::set_bias`].
    pub fn guess_bias(&mut self, rate: AngularRate<T>) -> bool {
        self.bias.guess(rate)
    }

    /// What the gyro reads when nothing turns, and how that is known.
    pub fn bias(&self) -> &Bias<T> {
        &self.bias
    }

    /// Still or moving, and for how long.
    pub fn motion(&self) -> Motion {
        self.rest.motion()
    }

    /// At rest: how fast the orientation still turns, that is the heading's drift, in the body's axes.
    /// None on the move, when nobody can tell.
    pub fn residual(&self) -> Option<AngularRate<T>> {
        self.is_still()
            .then(|| AngularRate::from_rad_per_s(self.rest.mean_rate() - self.bias.rad_per_s()))
    }

    /// What the compass is worth at the moment.
    pub fn field_verdict(&self) -> FieldVerdict {
        self.heading.verdict()
    }

    /// Samples that were no measurements.
    pub fn refused(&self) -> u32 {
        self.refused
    }
}

/// Every component finite and not beyond `limit`.
fn within<T: RealField + Copy>(v: Vector3<T>, limit: f64) -> bool {
    let limit: T = convert(limit);
    // Written so that what is not a number is not within.
    v.iter().all(|component| component.abs() <= limit)
}
