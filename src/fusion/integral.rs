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
    /// Samples since the start, counted in eights.
    age: u32,
    /// Fields since the start that told of the heading.
    fields: u32,
}

#[derive(Clone, Copy, Debug)]
struct Coefficients<T> {
    /// Share of the axes of now in [`DECIMATION`] samples.
    low_pass: T,
    /// Gain in [`DECIMATION`] samples, 1/s.
    tilt: T,
    /// Samples until the gain is the lasting one.
    tilt_start: u32,
    /// Samples in a second.
    tilt_second: u32,
    /// Gains in a field, 1/s.
    heading: T,
    heading_start: T,
    /// Fields in a second; before so many the heading has not settled.
    field_second: u32,
    /// Samples.
    rest_worth: u32,
}

/// Until the first rest gains fall as one over a second, and the time since the start.
pub const SECOND: f64 = 1.0;
/// An error of tilt beyond this (rad, 3°) is a knock's, not a bias's.
pub const LARGEST_ERROR: f64 = 0.05;
/// The same of the heading (rad, 11°): beyond it the field is wrong.
pub const LARGEST_HEADING_ERROR: f64 = 0.2;

impl<T: RealField + Copy> Coefficients<T> {
    fn new(parameters: &Parameters<T>, rates: Rates<T>) -> Self {
        let block = Seconds(rates.sample.0 * scalar(DECIMATION));
        let second = Seconds(convert(SECOND));
        Self {
            low_pass: tilt_low_pass_weight(parameters, block),
            tilt: size(parameters.tilt_integral * block.0),
            tilt_start: samples(parameters.tilt_integral_start, rates.sample),
            tilt_second: samples(second, rates.sample),
            heading: size(parameters.heading_integral * rates.field.0),
            heading_start: size(parameters.heading_integral_start * rates.field.0),
            field_second: samples(second, rates.field),
            rest_worth: samples(parameters.rest_worth, rates.sample),
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

    /// Once in a block, at rest or not, but not in the first second, in which the tilt is still being found.
    pub fn follow(&mut self, inclination: &Inclination<T>) {
        self.age = self.age.saturating_add(DECIMATION);
        if !inclination.is_settled() {
            return;
        }
        let now = [Vector3::x(), Vector3::z()].map(|axis| inclination.in_body(axis));
        let before = self.axes.unwrap_or(now);
        let low_pass = self.coefficients.low_pass;
        self.axes = Some([0, 1].map(|i| before[i] + (now[i] - before[i]) * low_pass));
    }

    /// Then what the error of tilt says of how far the bias is off, rad/s in the body's axes, times the gain.
    /// None in the first second.
    ///
    /// Until the first rest nothing is known, so the gain begins high and falls as 1/(1 s + t):
    /// k_i max(1, t₀/(1 s + t)). A rest tells more of the bias than any motion: after one it is k_i.
    pub fn of_tilt(&self, error: [T; 2], source: Source) -> Option<Vector3<T>> {
        let [x, z] = self.axes?;
        let gain = self.tilt_gain(source);
        let largest: T = convert(LARGEST_ERROR);
        let error = error.map(|e| e.clamp(-largest, largest) * gain);
        Some(x * error[0] + z * error[1])
    }

    /// With every field that tells of the heading: what its error, a sine, says of the bias, as above. None
    /// in the compass's first second.
    ///
    /// Until the first rest this gain begins high too. A rest tells more than any compass near steel: after
    /// one it comes back only as the temperature may have changed.
    pub fn of_heading(
        &mut self,
        inclination: &Inclination<T>,
        error: T,
        source: Source,
    ) -> Option<Vector3<T>> {
        let gain = self.heading_gain(source)?;
        let largest: T = convert(LARGEST_HEADING_ERROR);
        let error = error.clamp(-largest, largest);
        Some(inclination.in_body(Vector3::y() * (error * gain)))
    }

    fn tilt_gain(&self, source: Source) -> T {
        let Coefficients {
            tilt,
            tilt_start,
            tilt_second,
            ..
        } = self.coefficients;
        if source != Source::Unmeasured {
            return tilt;
        }
        let time = self.age.saturating_add(tilt_second);
        size(tilt * (scalar::<T>(tilt_start) / scalar(time)).max(T::one()))
    }

    /// None in the compass's first second.
    fn heading_gain(&mut self, source: Source) -> Option<T> {
        let Coefficients {
            heading,
            heading_start,
            field_second,
            rest_worth,
            ..
        } = self.coefficients;
        self.fields = self.fields.saturating_add(1);
        if self.fields <= field_second {
            return None;
        }
        Some(match source {
            Source::Unmeasured => {
                let time = self.fields.saturating_add(field_second);
                heading.max(heading_start * (scalar::<T>(field_second) / scalar(time)))
            }
            Source::Rest { samples } => heading * weight(scalar::<T>(samples) / scalar(rest_worth)),
        })
    }
}
