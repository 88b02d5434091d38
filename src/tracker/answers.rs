//! Lines in answer to lines: `OK …`, or `ERR` and the word that was wrong.

use super::Tracker;
use super::estimators::Estimators;
use crate::command::request::{Choice, CoreClock, Format, Refusal, Request, Setting, UseCompass};
use crate::fixed::fusion::Fusion;
use crate::fixed::multiply::Multiply;
use crate::fusion::{Motion, Source};
use crate::sampling::Lock;
use crate::units::AngularRate;
use crate::wire::provenance::Compass;
use crate::wire::{self, Decimals, Line};

impl<M: Multiply> Tracker<M> {
    /// Does what a line asks for and says how it is now.
    pub(super) fn answer(&mut self, line: Result<Request, Refusal>) -> Line {
        let estimators = &mut self.estimators;
        match line {
            Err(refusal) => wire::text(format_args!("ERR {refusal}")),
            Ok(Request::Help) => wire::text(
                "OK verbs: help version estimator get set defaults compass calibration keep forget bias decimals stream every lock core",
            ),
            Ok(Request::Version) => wire::text(concat!("OK vrduino ", env!("CARGO_PKG_VERSION"))),
            Ok(Request::Estimator(choice)) => {
                if let Some(choice) = choice {
                    estimators.choose(choice);
                }
                wire::text(format_args!("OK estimator {}", estimators.choice().name()))
            }
            Ok(Request::Get(setting)) => value(estimators, setting),
            Ok(Request::Set(setting, wanted)) => {
                estimators.set(setting, wanted);
                value(estimators, setting)
            }
            Ok(Request::Defaults) => {
                estimators.set_defaults();
                self.stream.set_defaults();
                self.use_compass = UseCompass::default();
                self.lock = Lock::default();
                self.core = CoreClock::default();
                wire::text("OK defaults")
            }
            Ok(Request::Compass(choice)) => {
                if let Some(choice) = choice {
                    self.use_compass = choice;
                }
                self.compass_state()
            }
            Ok(Request::CompassAdjustment) => self.adjustment_state(),
            Ok(Request::Calibration) => self.calibration.state(),
            Ok(Request::Keep(piece)) => self.calibration.take(&piece),
            Ok(Request::KeepDone) => match self.calibration.finish() {
                Ok(record) => {
                    self.guess_bias(&record);
                    self.calibration.state()
                }
                Err(error) => wire::text(format_args!("ERR done: {error}")),
            },
            Ok(Request::Forget) => {
                self.calibration.forget();
                self.calibration.state()
            }
            Ok(Request::Decimals(decimals)) => {
                if let Some(decimals) = decimals {
                    self.stream.set_decimals(decimals);
                }
                self.decimals_state()
            }
            Ok(Request::Stream(format)) => {
                if let Some(format) = format {
                    self.stream.choose(format);
                }
                self.stream_state()
            }
            Ok(Request::Every(samples)) => {
                if let Some(samples) = samples {
                    self.stream.set_every(samples);
                }
                self.stream_state()
            }
            Ok(Request::Bias) => bias(estimators),
            Ok(Request::Core(core)) => {
                if let Some(core) = core {
                    self.core = core;
                }
                wire::text(format_args!("OK core {} MHz", self.core.mhz()))
            }
            Ok(Request::Lock(lock)) => {
                if let Some(lock) = lock {
                    self.lock = lock;
                }
                wire::text(format_args!("OK lock {}", self.lock.name()))
            }
        }
    }
}

impl<M: Multiply> Tracker<M> {
    fn stream_state(&self) -> Line {
        let (format, every) = (self.stream.format().name(), self.stream.every());
        wire::text(format_args!("OK stream {format} every {every}"))
    }

    fn decimals_state(&self) -> Line {
        let decimals = self.stream.decimals();
        let most = Decimals::MOST_TIMED;
        match self.stream.format() {
            Format::Timed if decimals > most => wire::text(format_args!(
                "OK decimals {}, {} in timed lines",
                decimals.get(),
                most.get()
            )),
            _ => wire::text(format_args!("OK decimals {}", decimals.get())),
        }
    }

    /// The choice, and what it comes to.
    fn compass_state(&self) -> Line {
        let choice = match self.use_compass {
            UseCompass::Auto => "auto",
            UseCompass::On => "on",
            UseCompass::Off => "off",
        };
        let state = match self.compass_use() {
            Compass::Absent => "no field",
            Compass::Unused if self.estimators.choice() == Choice::Notes => {
                "not used by the notes' filter"
            }
            Compass::Unused => "not used, the field is not calibrated",
            Compass::Followed => "heading by compass",
            Compass::Disturbed => "disturbed, heading by gyro",
        };
        match self.use_compass {
            UseCompass::Off => wire::text("OK compass off"),
            _ => wire::text(format_args!("OK compass {choice}: {state}")),
        }
    }

    /// What turns the magnetometer's counts, as they are streamed, into a field.
    #[cold]
    #[inline(never)]
    fn adjustment_state(&self) -> Line {
        match self.compass.adjustment() {
            Some(adjustment) => {
                let [x, y, z] = adjustment.fuse_rom();
                wire::text(format_args!("OK compass adjustment {x} {y} {z}"))
            }
            None => wire::text("OK compass adjustment none, there is no magnetometer"),
        }
    }
}

fn value<M: Multiply>(estimators: &Estimators<M>, setting: Setting) -> Line {
    let value = estimators.get(setting);
    wire::answer(setting.name(), value, setting.decimals(), setting.unit())
}

/// What the gyro reads at rest, and how that is known.
fn bias<M: Multiply>(estimators: &Estimators<M>) -> Line {
    let rate = estimators.bias().rate();
    match estimators.choice() {
        Choice::Notes if estimators.bias_is_measured() => {
            wire::bias(rate, format_args!("as it was when it was chosen"))
        }
        Choice::Notes => wire::bias(rate, format_args!("never still, a guess")),
        Choice::Default => verdict(estimators.fusion(), rate),
    }
}

fn verdict<M: Multiply>(fusion: &Fusion<M>, rate: AngularRate<f32>) -> Line {
    let seconds = |samples: u32| samples / 1000;
    match (fusion.motion(), fusion.bias().source()) {
        (Motion::Still { samples }, _) => {
            let residual = fusion
                .residual()
                .map_or(0.0, |rate| rate.dps().norm() * 60.0);
            let tenths = (residual * 10.0 + 0.5) as u32;
            wire::bias(
                rate,
                format_args!(
                    "still {} s, residual {}.{} deg/min",
                    seconds(samples),
                    tenths / 10,
                    tenths % 10
                ),
            )
        }
        (Motion::Moving { .. }, Source::Rest { samples }) => wire::bias(
            rate,
            format_args!("moving, at rest {} s ago", seconds(samples)),
        ),
        (Motion::Moving { .. }, Source::Unmeasured) => {
            wire::bias(rate, format_args!("never still, a guess"))
        }
    }
}
