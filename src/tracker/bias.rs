//! The gyro's bias: measured while the board lies still, and told of.

use super::{Phase, STILL_DEADLINE, Tracker};
use crate::calibration::{Stillness, Verdict};
use crate::fixed::fusion::Force;
use crate::fixed::multiply::Multiply;
use crate::sensor::{Ranges, RawSample};
use crate::wire::{self, Line};

/// Samples between reminders that the bias is not known: a minute.
const REMIND_EVERY: u32 = 60_000;

/// A measurement of the bias under way.
#[derive(Clone, Debug)]
pub struct Measurement {
    pub stillness: Stillness,
    pub samples: u32,
}

impl Measurement {
    pub fn new(ranges: Ranges) -> Self {
        Self {
            stillness: Stillness::new(ranges),
            samples: 0,
        }
    }
}

impl<M: Multiply> Tracker<M> {
    #[inline(never)]
    pub(super) fn measure(&mut self, raw: &RawSample, emit: &mut impl FnMut(&Line)) {
        let Some(measurement) = &mut self.measurement else {
            return;
        };
        if measurement.samples == 0 {
            emit(&wire::text("Measuring bias"));
        }
        measurement.samples += 1;
        let starting = self.phase == Phase::Starting;
        match measurement.stillness.push(raw) {
            Verdict::Still(rest) => {
                self.measurement = None;
                self.estimators.set_bias(rest.gyro_bias);
                self.bias_unknown = false;
                self.rest = Some(rest);
                if starting {
                    self.start(Force::new(rest.force, self.ranges.accel));
                }
                emit(&wire::bias_measured(rest.gyro_bias));
            }
            Verdict::Collecting | Verdict::Moved => {
                if measurement.samples >= STILL_DEADLINE {
                    self.measurement = None;
                    if starting {
                        self.start(self.force(raw));
                        emit(&wire::text(
                            "warning: not still for 5 s, gyro bias unknown: lay the board down for two seconds",
                        ));
                    } else {
                        emit(&wire::text("warning: moved for 5 s, gyro bias kept"));
                    }
                }
            }
        }
    }

    /// A board that was never still streams all the same, and says now and then that it drifts; its
    /// first rest is told of.
    #[cold]
    #[inline(never)]
    pub(super) fn tell_of_bias(&mut self, emit: &mut impl FnMut(&Line)) {
        let unknown = !self.estimators.bias_is_measured();
        if self.bias_unknown && !unknown {
            emit(&wire::bias_measured(self.estimators.bias().rate()));
        }
        self.bias_unknown = unknown;
        if unknown && self.every(REMIND_EVERY) {
            emit(&wire::text(
                "warning: never still yet, the heading drifts: lay the board down for two seconds",
            ));
        }
    }
}
