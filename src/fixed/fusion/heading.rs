//! A turn about the vertical, kept beside the inclination: a compass that is wrong turns the picture
//! and corrects no tilt.

use super::super::division::per;
use super::super::inclination::horizontal;
use super::super::multiply::Multiply;
use super::super::number::Q;
use super::super::quaternion::Quaternion;
use super::super::turn::Turn;
use super::super::vector::Vector;
use super::disturbance::Disturbance;
use super::parameters::{Rates, samples, seconds, squared};
use crate::fusion::heading::{RENEWED, TURNING_DPS};
use crate::fusion::parameters::low_pass_weight;
use crate::fusion::{FieldVerdict, Parameters};
use crate::units::Seconds;
use core::num::NonZeroU32;

/// The compass.
#[derive(Clone, Copy, Debug)]
pub struct Heading<M> {
    low_pass: Q<M, 31>,
    /// Counts of the gyro, squared, as Q30.
    turning: u64,
    disturbance: Disturbance<M>,
    /// To north.
    turn: Turn<M>,
    /// The turn after it, from north to what is to be straight ahead.
    ahead: Turn<M>,
    /// Fields since the start, or since the reference changed: the first weigh alike.
    age: u32,
    renewed: u32,
}

impl<M: Multiply> Heading<M> {
    pub fn new(parameters: &Parameters<f32>, rates: &Rates) -> Self {
        Self {
            low_pass: low_pass(parameters, rates),
            turning: squared(TURNING_DPS as f32 * rates.counts_per_dps()),
            disturbance: Disturbance::new(parameters, rates.field),
            turn: Turn::NONE,
            ahead: Turn::NONE,
            age: 0,
            renewed: samples(Seconds(RENEWED as f32), rates.field),
        }
    }

    pub fn tune(&mut self, parameters: &Parameters<f32>, rates: &Rates) {
        self.low_pass = low_pass(parameters, rates);
        self.disturbance.tune(parameters, rates.field);
    }

    /// One field, µT, in the world of the inclination. Returns the error of the heading before it was
    /// corrected, or none if the field tells nothing: it is disturbed, or has no horizontal part.
    ///
    /// The error is the sine m_x/h of the angle, ±1 beyond a quarter turn. Of it a share of
    /// max(1 − e^(−Δt/τ), 1/n) is corrected.
    #[inline(always)]
    pub fn update(&mut self, field: Vector<M, 12>, rate: Vector<M, 15>) -> Option<Q<M, 30>> {
        // The direction does not mind which power of two the field is read with.
        let (x, z, h) = horizontal(field.x.read_as::<30>(), field.z.read_as::<30>())?;
        let h: Q<M, 12> = h.read_as();
        // Below 0.01 µT there is no north.
        if h.bits() < const { Q::<M, 12>::constant(0.01).bits() } {
            return None;
        }
        let turning = rate.squared() > self.turning;
        let renewed = self.disturbance.update([h, field.y], turning);
        if renewed {
            self.age = self.age.min(self.renewed);
        }
        if self.disturbance.verdict() != FieldVerdict::Undisturbed {
            return None;
        }
        self.age = self.age.saturating_add(1);
        let [cos, sin] = self.turn.cos_and_sin();
        let sine = Q::<M, 26>::product(cos, x).plus(sin, z);
        let cosine = Q::<M, 26>::product(cos, z).minus(sin, x);
        // North is −z.
        let one = const { Q::<M, 30>::constant(1.0) };
        let error = match (cosine.bits() > 0, sine.bits() < 0) {
            (true, true) => -one,
            (true, false) => one,
            (false, _) => sine.finer::<30>(),
        };
        let share: Q<M, 31> = per(NonZeroU32::new(self.age).unwrap_or(NonZeroU32::MIN));
        let share = Q::<M, 31>::from_bits(share.bits().max(self.low_pass.bits()));
        let half = Q::<M, 29>::product(error, share).read_as::<30>();
        self.turn = self.turn.turned(half.finer());
        Some(error)
    }

    /// The turn about y, world of the inclination to world.
    pub fn turn(&self) -> Turn<M> {
        self.ahead.after(self.turn)
    }

    /// From now on this orientation, body to world of the inclination, looks straight ahead: its own
    /// turn about y is taken back.
    pub fn look_ahead(&mut self, orientation: Quaternion<M>) {
        let [w, _, y, _] = orientation.upper();
        let twist = self.turn.after(Turn::from_halves([w, y]));
        // Halved, so that none is above ½.
        let [c, s] = twist.halves().map(|half| Q::from_bits(half.bits() >> 1));
        let Some((c, s, length)) = horizontal(c, s) else {
            return;
        };
        // Upside down there is no turn about y to speak of.
        if length.bits() > const { Q::<M, 30>::constant(0.5e-6).bits() } {
            self.ahead = Turn::from_halves([c, -s]);
        }
    }

    pub fn verdict(&self) -> FieldVerdict {
        self.disturbance.verdict()
    }
}

fn low_pass<M: Multiply>(parameters: &Parameters<f32>, rates: &Rates) -> Q<M, 31> {
    let weight = low_pass_weight(parameters.heading_time, seconds(rates.field));
    Q::nearest(weight).limited(per(NonZeroU32::MIN))
}
