//! What of the tracker a host sees.

use super::{Health, INFO_EVERY, SAMPLE_MICROS, Tracker};
use crate::command::Mode;
use crate::command::request::Choice;
use crate::fixed::multiply::Multiply;
use crate::fusion::{FieldVerdict, Motion};
use crate::orientation::angles;
use crate::wire::frame::{Counts, Frame};
use crate::wire::provenance::Compass;
use crate::wire::{self, Line, Q30, Status, Tag};

impl<M: Multiply> Tracker<M> {
    /// Samples from one time that something is shown to the next.
    #[inline(always)]
    pub(super) fn shown_every(&self) -> u32 {
        match self.mode {
            Mode::Info => INFO_EVERY,
            _ => u32::from(self.stream.every()),
        }
    }

    /// What is due.
    #[inline(never)]
    pub(super) fn show(
        &mut self,
        counts: &Counts,
        health: &Health,
        emit: &mut impl FnMut(&Line),
    ) -> Option<Frame> {
        let raw = &counts.sample;
        if self.mode == Mode::Info {
            self.show_info(health, emit);
            return None;
        }
        match self.mode {
            Mode::Info => {}
            Mode::Flat => emit(&wire::flat(&self.views.roll())),
            Mode::ThreeD => {
                let gyro = Q30(self.views.gyro());
                emit(&wire::quaternion(Tag::Gyro, gyro, self.stream.decimals()));
                let force = self.sample(raw).force;
                emit(&wire::angles(&angles::pitch_and_roll(force)));
            }
            Mode::Gyro => emit(&wire::gyro(self.reading(raw).rate())),
            Mode::Accel => emit(&wire::force(self.sample(raw).force)),
            Mode::Quaternion => {}
        }
        if !matches!(self.mode, Mode::ThreeD | Mode::Quaternion) {
            return None;
        }
        let (q, status) = (Q30(self.estimators.orientation()), self.status(counts));
        self.stream.fused(q, self.micros(), status, counts, emit)
    }

    /// Device time at which the sensor had the sample ready, in µs since the start: where nobody says so, by the number
    /// of samples.
    fn micros(&self) -> u32 {
        match self.timing {
            Some(timing) => timing.micros as u32,
            None => self.ticks.wrapping_mul(SAMPLE_MICROS),
        }
    }

    fn status(&self, counts: &Counts) -> Status {
        let estimators = &self.estimators;
        let notes = estimators.choice() == Choice::Notes;
        Status {
            repeated: !counts.sample.fresh,
            clipped: counts.sample.clipped(),
            still: !notes && matches!(estimators.fusion().motion(), Motion::Still { .. }),
            compass: self.compass_use(),
            notes,
            bias_measured: estimators.bias_is_measured(),
            skipped: self.timing.is_some_and(|timing| timing.lost > 0),
        }
    }

    /// What the magnetometer does for the heading.
    pub(super) fn compass_use(&self) -> Compass {
        if self.compass.per_second() == 0 {
            return Compass::Absent;
        }
        if !self.follows_compass() || self.estimators.choice() == Choice::Notes {
            return Compass::Unused;
        }
        match self.estimators.fusion().field_verdict() {
            FieldVerdict::Absent => Compass::Absent,
            FieldVerdict::Undisturbed => Compass::Followed,
            FieldVerdict::Disturbed => Compass::Disturbed,
        }
    }

    fn show_info(&self, health: &Health, emit: &mut impl FnMut(&Line)) {
        emit(&wire::reads_per_second(self.counts.fresh_last_second));
        emit(&wire::gyro_bias(self.estimators.bias().rate()));
        // Nothing is known of the rest if the board never rested.
        if let Some(rest) = &self.rest {
            emit(&wire::gyro_variance(rest));
            emit(&wire::force_mean(rest));
            emit(&wire::force_variance(rest));
        }
        emit(&wire::dropped(health.dropped_lines));
        emit(&wire::repeated(self.counts.repeated));
        emit(&wire::overruns(health.overruns));
        emit(&wire::clipped(self.counts.clipped));
        match self.compass.recent() {
            Some(Ok(field)) => emit(&wire::field(field, self.compass.per_second())),
            Some(Err(error)) => emit(&wire::text(format_args!("Field: {error}"))),
            None => emit(&wire::no_field()),
        }
        emit(&wire::fields_skipped(health.skipped_fields));
    }
}
