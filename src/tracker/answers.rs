//! Lines in answer to lines: `OK …`, or `ERR` and the word that was wrong.

use super::Tracker;
use super::estimators::Estimators;
use crate::command::request::{Choice, Refusal, Request, Setting};
use crate::fusion::{Fusion, Motion, Source};
use crate::units::AngularRate;
use crate::wire::{self, Line};

impl Tracker {
    /// Does what a line asks for and says how it is now.
    pub(super) fn answer(&mut self, line: Result<Request, Refusal>) -> Line {
        let estimators = &mut self.estimators;
        match line {
            Err(refusal) => wire::text(format_args!("ERR {refusal}")),
            Ok(Request::Help) => wire::text(
                "OK verbs: help version estimator get set defaults compass bias decimals",
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
                wire::text("OK defaults")
            }
            Ok(Request::Compass(on)) => {
                if let Some(on) = on {
                    estimators.set_compass(on);
                }
                let state = if estimators.compass() { "on" } else { "off" };
                wire::text(format_args!("OK compass {state}"))
            }
            Ok(Request::Decimals(decimals)) => {
                if let Some(decimals) = decimals {
                    self.decimals = decimals;
                }
                wire::text(format_args!("OK decimals {}", self.decimals.get()))
            }
            Ok(Request::Bias) => bias(estimators),
        }
    }
}

fn value(estimators: &Estimators, setting: Setting) -> Line {
    let name = setting.name();
    wire::answer(name, estimators.get(setting), setting.unit())
}

/// What the gyro reads at rest, and how that is known.
fn bias(estimators: &Estimators) -> Line {
    let rate = estimators.bias().rate();
    match estimators.choice() {
        Choice::Notes => wire::bias(rate, format_args!("measured once")),
        Choice::Default => verdict(estimators.fusion(), rate),
    }
}

fn verdict(fusion: &Fusion<f32>, rate: AngularRate<f32>) -> Line {
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
