//! The field of the earth is the same wherever the sensor points: its horizontal and its vertical
//! part stay. Near steel or a magnet they do not.

use super::parameters::{Parameters, samples, share, weight};
use crate::units::Seconds;
use nalgebra::{RealField, convert};

/// What the field is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldVerdict {
    /// There has been no field yet.
    Absent,
    /// It is that of the reference: the heading follows it.
    Undisturbed,
    /// It is not: the heading is the gyro's.
    Disturbed,
}

/// A field by the size of its horizontal part and its vertical part, µT.
pub type Dip<T> = [T; 2];

/// Keeps a reference, and watches for a better one.
#[derive(Clone, Copy, Debug)]
pub struct Disturbance<T: RealField> {
    coefficients: Coefficients<T>,
    reference: Option<Dip<T>>,
    /// Fields like the reference that were met while turning.
    met: u32,
    /// Another field, the mean of what does not fit the reference.
    candidate: Dip<T>,
    candidate_met: u32,
    candidate_age: u32,
    age: u32,
    verdict: FieldVerdict,
}

#[derive(Clone, Copy, Debug)]
struct Coefficients<T> {
    /// Squared, of the reference's squared size.
    tolerance: T,
    follow: T,
    candidate_follow: T,
    least: u32,
    most: u32,
}

/// How quickly the candidate follows the field that does not fit, s.
pub const CANDIDATE_TIME: f64 = 5.0;

impl<T: RealField + Copy> Coefficients<T> {
    fn new(parameters: &Parameters<T>, period: Seconds<T>) -> Self {
        let [least, most] = parameters.new_field_time.map(|time| samples(time, period));
        Self {
            tolerance: parameters.field_tolerance * parameters.field_tolerance,
            follow: weight(period.0 / parameters.field_time.0),
            candidate_follow: weight(period.0 / convert(CANDIDATE_TIME)),
            least,
            most,
        }
    }
}

impl<T: RealField + Copy> Disturbance<T> {
    pub fn new(parameters: &Parameters<T>, period: Seconds<T>) -> Self {
        Self {
            coefficients: Coefficients::new(parameters, period),
            reference: None,
            met: 0,
            candidate: [T::zero(); 2],
            candidate_met: 0,
            candidate_age: 0,
            age: 0,
            verdict: FieldVerdict::Absent,
        }
    }

    pub fn tune(&mut self, parameters: &Parameters<T>, period: Seconds<T>) {
        self.coefficients = Coefficients::new(parameters, period);
    }

    /// One field. `turning` says whether the sensor turns: only then does a constant field tell
    /// anything, for beside a magnet at rest the field is as constant as the earth's.
    ///
    /// The first field is the reference, unproven; a field met for longer while turning than the
    /// reference takes its place. True if it does with this field.
    pub fn update(&mut self, field: Dip<T>, turning: bool) -> bool {
        let Some(reference) = self.reference else {
            self.reference = Some(field);
            self.age = 1;
            self.verdict = FieldVerdict::Undisturbed;
            return true;
        };
        self.age = self.age.saturating_add(1);
        let Coefficients {
            tolerance,
            follow,
            candidate_follow,
            least,
            most,
        } = self.coefficients;
        if fits(field, reference, tolerance) {
            self.verdict = FieldVerdict::Undisturbed;
            self.reference = Some(towards(reference, field, follow.max(share(self.age))));
            self.met = self.met.saturating_add(u32::from(turning)).min(most);
            self.forget();
            return false;
        }
        self.verdict = FieldVerdict::Disturbed;
        let agrees = fits(field, self.candidate, tolerance);
        self.candidate_age = self.candidate_age.saturating_add(1);
        let weight = candidate_follow.max(share(self.candidate_age));
        self.candidate = towards(self.candidate, field, weight);
        if !agrees {
            self.forget();
        } else if turning {
            self.candidate_met += 1;
        }
        if self.candidate_met <= self.met.max(least) {
            return false;
        }
        self.reference = Some(self.candidate);
        self.met = self.candidate_met;
        (self.candidate_met, self.candidate_age) = (0, 0);
        self.verdict = FieldVerdict::Undisturbed;
        true
    }

    /// The candidate was not met this time.
    fn forget(&mut self) {
        self.candidate_met = self.candidate_met.saturating_sub(1);
        if self.candidate_met == 0 && self.verdict == FieldVerdict::Undisturbed {
            self.candidate_age = 0;
        }
    }

    pub fn verdict(&self) -> FieldVerdict {
        self.verdict
    }
}

fn fits<T: RealField + Copy>(field: Dip<T>, reference: Dip<T>, tolerance: T) -> bool {
    let square = |v: Dip<T>| v[0] * v[0] + v[1] * v[1];
    let difference = [field[0] - reference[0], field[1] - reference[1]];
    square(difference) < tolerance * square(reference)
}

fn towards<T: RealField + Copy>(from: Dip<T>, to: Dip<T>, weight: T) -> Dip<T> {
    [0, 1].map(|i| from[i] + (to[i] - from[i]) * weight)
}
