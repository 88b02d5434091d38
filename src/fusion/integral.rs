//! What the errors of tilt and heading say of the gyro's bias while the board moves: they are what the
//! bias adds up to.

use super::bias::Source;
use super::inclination::Inclination;
use super::parameters::{
    DECIMATION, Parameters, Rates, samples, scalar, size, tilt_low_pass_weight, weight,
};
use crate::units::Seconds;
use nalgebra::{RealField, Vector3, convert};

/// Gains, and the axes along which an error of tilt is laid to the bias.
#[derive(Clone, Copy, Debug)]
pub struct Integral<T: RealField> {
    coefficients: Coefficients<T>,
    /// The world's x and z as the body sees them, low-passed like the error of tilt.
    ///
    /// That error is seconds old. While the body turns, a bias that is fixed to it has by then turned
    /// on in the world; laid along the axes of *now* the error would go to the wrong side of any turn
    /// faster than ω₀. VQF filters the whole rotation matrix for the same reason.
    axes: Option<[Vector3<T>; 2]>,
    /// Samples since the start.
    age: u32,
    /// Fields since the start that told of the heading.
    fields: u32,
}

#[derive(Clone, Copy, Debug)]
struct Coefficients<T> {
    period: T,
    field_period: T,
    /// Share of the axes of now in [`DECIMATION`] samples.
    low_pass: T,
    /// Gain in [`DECIMATION`] samples, 1/s.
    tilt: T,
    tilt_start: T,
    /// Samples until the gain is the lasting one.
    tilt_start_samples: u32,
    heading: T,
    heading_start: T,
    rest_worth: T,
    /// Fields before the first of which the heading has not settled.
    field_start: u32,
}

/// The compass is left alone for its first second, s.
const FIELD_START: f64 = 1.0;
/// An error of tilt beyond this (rad, 3°) is a knock's, not a bias's.
const LARGEST_ERROR: f64 = 0.05;
/// The same of the heading (rad, 11°): beyond it the field is wrong.
const LARGEST_HEADING_ERROR: f64 = 0.2;

impl<T: RealField + Copy> Coefficients<T> {
    fn new(parameters: &Parameters<T>, rates: Rates<T>) -> Self {
        let every: T = scalar(DECIMATION);
        Self {
            period: size(rates.sample.0),
            field_period: size(rates.field.0),
            low_pass: tilt_low_pass_weight(parameters, Seconds(rates.sample.0 * every)),
            tilt: size(parameters.tilt_integral * rates.sample.0 * every),
            tilt_start: size(parameters.tilt_integral_start.0),
            tilt_start_samples: samples(parameters.tilt_integral_start, rates.sample),
            heading: size(parameters.heading_integral * rates.field.0),
            heading_start: size(parameters.heading_integral_start * rates.field.0),
            rest_worth: size(parameters.rest_worth.0),
            field_start: samples(Seconds(convert(FIELD_START)), rates.field),
        }
    }
}

impl<T: RealField + Copy> Integral<T> {
    pub fn new(parameters: &Parameters<T>, rates: Rates<T>) -> Self {
        Self {
            coefficients: Coefficients::new(parameters, rates),
            axes: None,
            age: 0,
            fields: 0,
        }
    }

    pub fn tune(&mut self, parameters: &Parameters<T>, rates: Rates<T>) {
        self.coefficients = Coefficients::new(parameters, rates);
    }

    /// One sample, at rest or not: how far the bias is off, rad/s in the body's axes, times the gain.
    /// None where there is nothing to add: the tilt's error is looked at in every eighth sample, the
    /// heading's with every field. In the first second the tilt is still being found.
    ///
    /// Until the first rest nothing is known, so the gains begin high and fall as 1/(1 + t): that for
    /// tilt is k_i max(1, t₀/(1 + t)). A rest tells more of the bias than any motion, and more than any
    /// compass near steel: after one the tilt's gain is k_i, and the heading's comes back only as the
    /// temperature may have changed.
    pub fn update(
        &mut self,
        inclination: &Inclination<T>,
        heading_error: Option<T>,
        source: Source,
    ) -> Option<Vector3<T>> {
        self.age = self.age.saturating_add(1);
        let due = self.age.is_multiple_of(DECIMATION) && inclination.is_settled();
        let tilt = due.then(|| {
            let [x, z] = self.follow(inclination);
            let gain = self.tilt_gain(source);
            let largest: T = convert(LARGEST_ERROR);
            let error = inclination
                .error()
                .map(|e| e.clamp(-largest, largest) * gain);
            x * error[0] + z * error[1]
        });
        let heading = heading_error.and_then(|error| {
            let gain = self.heading_gain(source)?;
            let largest: T = convert(LARGEST_HEADING_ERROR);
            let error = error.clamp(-largest, largest);
            Some(inclination.in_body(Vector3::y() * (error * gain)))
        });
        match (tilt, heading) {
            (Some(tilt), Some(heading)) => Some(tilt + heading),
            (tilt, heading) => tilt.or(heading),
        }
    }

    fn follow(&mut self, inclination: &Inclination<T>) -> [Vector3<T>; 2] {
        let now = [Vector3::x(), Vector3::z()].map(|axis| inclination.in_body(axis));
        let before = self.axes.unwrap_or(now);
        let low_pass = self.coefficients.low_pass;
        let axes = [0, 1].map(|i| before[i] + (now[i] - before[i]) * low_pass);
        self.axes = Some(axes);
        axes
    }

    fn tilt_gain(&self, source: Source) -> T {
        let Coefficients {
            period,
            tilt,
            tilt_start,
            tilt_start_samples,
            ..
        } = self.coefficients;
        if source != Source::Unmeasured || self.age > tilt_start_samples {
            return tilt;
        }
        let time = scalar::<T>(self.age) * period;
        tilt * (tilt_start / (T::one() + time)).max(T::one())
    }

    /// None in the compass's first second.
    fn heading_gain(&mut self, source: Source) -> Option<T> {
        let Coefficients {
            period,
            field_period,
            heading,
            heading_start,
            rest_worth,
            field_start,
            ..
        } = self.coefficients;
        self.fields = self.fields.saturating_add(1);
        if self.fields <= field_start {
            return None;
        }
        Some(match source {
            Source::Unmeasured => {
                let time = scalar::<T>(self.fields) * field_period;
                heading.max(heading_start / (T::one() + time))
            }
            Source::Rest { samples } => {
                heading * weight(scalar::<T>(samples) * period / rest_worth)
            }
        })
    }
}
