//! The field of the earth is the same wherever the sensor points: its horizontal and its vertical
//! part stay. Near steel or a magnet they do not.

use super::super::division::per;
use super::super::gyro::Nanoseconds;
use super::super::multiply::Multiply;
use super::super::number::{Q, Wide};
use super::parameters::{samples, seconds, weight};
use crate::fusion::disturbance::CANDIDATE_TIME;
use crate::fusion::{FieldVerdict, Parameters, parameters};
use crate::units::Seconds;
use core::num::NonZeroU32;

/// A field by the size of its horizontal part and its vertical part, µT.
pub type Dip<M> = [Q<M, 12>; 2];

/// Keeps a reference, and watches for a better one.
#[derive(Clone, Copy, Debug)]
pub struct Disturbance<M> {
    coefficients: Coefficients<M>,
    reference: Option<[Wide<M, 44>; 2]>,
    /// Fields like the reference that were met while turning.
    met: u32,
    /// Another field, the mean of what does not fit the reference.
    candidate: [Wide<M, 44>; 2],
    candidate_met: u32,
    candidate_age: u32,
    age: u32,
    verdict: FieldVerdict,
}

#[derive(Clone, Copy, Debug)]
struct Coefficients<M> {
    /// Squared, of the reference's squared size, as Q32; below 1.
    tolerance: u32,
    follow: Q<M, 32>,
    candidate_follow: Q<M, 32>,
    least: u32,
    most: u32,
}

impl<M: Multiply> Coefficients<M> {
    fn new(parameters: &Parameters<f32>, period: Nanoseconds) -> Self {
        let [least, most] = parameters.new_field_time.map(|time| samples(time, period));
        let share = |time: Seconds<f32>| weight(parameters::weight(seconds(period).0 / time.0));
        let tolerance = parameters.field_tolerance * parameters.field_tolerance;
        Self {
            tolerance: (tolerance * (1_u64 << 32) as f32) as u32,
            follow: share(parameters.field_time),
            candidate_follow: share(Seconds(CANDIDATE_TIME as f32)),
            least,
            most,
        }
    }
}

impl<M: Multiply> Disturbance<M> {
    pub fn new(parameters: &Parameters<f32>, period: Nanoseconds) -> Self {
        Self {
            coefficients: Coefficients::new(parameters, period),
            reference: None,
            met: 0,
            candidate: [Wide::from_bits(0); 2],
            candidate_met: 0,
            candidate_age: 0,
            age: 0,
            verdict: FieldVerdict::Absent,
        }
    }

    pub fn tune(&mut self, parameters: &Parameters<f32>, period: Nanoseconds) {
        self.coefficients = Coefficients::new(parameters, period);
    }

    /// One field. `turning` says whether the sensor turns: only then does a constant field tell
    /// anything. True if with it another field becomes the reference.
    #[inline(always)]
    pub fn update(&mut self, field: Dip<M>, turning: bool) -> bool {
        let Some(reference) = self.reference else {
            self.reference = Some(field.map(Wide::from_upper));
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
            self.reference = Some(towards(reference, field, follow, self.age));
            self.met = self.met.saturating_add(u32::from(turning)).min(most);
            self.forget();
            return false;
        }
        self.verdict = FieldVerdict::Disturbed;
        let agrees = fits(field, self.candidate, tolerance);
        self.candidate_age = self.candidate_age.saturating_add(1);
        self.candidate = if self.candidate_age == 1 {
            field.map(Wide::from_upper)
        } else {
            towards(self.candidate, field, candidate_follow, self.candidate_age)
        };
        if !agrees {
            self.forget();
        } else if turning {
            self.candidate_met = self.candidate_met.saturating_add(1);
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
    #[inline(always)]
    fn forget(&mut self) {
        self.candidate_met = self.candidate_met.saturating_sub(1);
        if self.candidate_met == 0 && self.verdict == FieldVerdict::Undisturbed {
            self.candidate_age = 0;
        }
    }

    #[inline(always)]
    pub fn verdict(&self) -> FieldVerdict {
        self.verdict
    }
}

#[inline(always)]
fn fits<M: Multiply>(field: Dip<M>, reference: [Wide<M, 44>; 2], tolerance: u32) -> bool {
    let square = |[a, b]: Dip<M>| (a.wide(a) + b.wide(b)) as u64;
    let reference: Dip<M> = reference.map(Wide::upper);
    let difference = [field[0] - reference[0], field[1] - reference[1]];
    square(difference) < share_of(square(reference), tolerance)
}

/// A share, as Q32, of a square.
#[inline(always)]
fn share_of(square: u64, share: u32) -> u64 {
    let share = u64::from(share);
    (square >> 32) * share + (((square & u64::from(u32::MAX)) * share) >> 32)
}

/// By `follow` of the way, or at first by 1/n.
#[inline(always)]
fn towards<M: Multiply>(
    from: [Wide<M, 44>; 2],
    to: Dip<M>,
    follow: Q<M, 32>,
    n: u32,
) -> [Wide<M, 44>; 2] {
    let share: Q<M, 32> = per(NonZeroU32::new(n).unwrap_or(NonZeroU32::MIN));
    let share = Q::from_bits(share.bits().max(follow.bits()));
    [from[0].towards(to[0], share), from[1].towards(to[1], share)]
}
