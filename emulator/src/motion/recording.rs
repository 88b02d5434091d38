//! A motion that was sampled: what a file holds once it has been read.

use super::rotation::between;
use super::{Instant, Motion};

/// A sampled motion, resampled to whatever instants the sensor asks for.
///
/// Between two samples, rate and force follow a straight line and the truth turns at constant
/// speed; where one of the two has no truth there is none between them either. After the last sample
/// the sensor lies still: rate zero, the last force and the last truth.
#[derive(Debug, Clone)]
pub struct Recording {
    kind: &'static str,
    name: Option<String>,
    /// Strictly increasing times (s), the first of them 0.
    times: Vec<f64>,
    instants: Vec<Instant>,
}

impl Recording {
    /// A recording of `kind` (a noun for people) from samples in strictly increasing order of their
    /// time (s). At least one is needed, else the result is `None`. Time is counted from the first.
    pub(super) fn new(kind: &'static str, samples: Vec<(f64, Instant)>) -> Option<Self> {
        let began = samples.first()?.0;
        let (times, instants) = samples.into_iter().map(|(t, i)| (t - began, i)).unzip();
        Some(Self {
            kind,
            name: None,
            times,
            instants,
        })
    }

    /// The same recording with the name it is described by.
    pub fn named(self, name: String) -> Self {
        Self {
            name: Some(name),
            ..self
        }
    }

    /// How many samples were read.
    pub fn samples(&self) -> usize {
        self.instants.len()
    }

    fn length(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }
}

impl Motion for Recording {
    fn at(&self, t: f64) -> Instant {
        let after = self.times.partition_point(|&time| time <= t).max(1);
        let earlier = self.instants[after - 1];
        let Some(&later) = self.instants.get(after) else {
            let moving = t <= self.length();
            return Instant {
                rate: if moving { earlier.rate } else { [0.0; 3] },
                ..earlier
            };
        };
        let (start, end) = (self.times[after - 1], self.times[after]);
        let fraction = ((t - start) / (end - start)).clamp(0.0, 1.0);
        Instant {
            rate: line(earlier.rate, later.rate, fraction),
            force: line(earlier.force, later.force, fraction),
            field: earlier
                .field
                .zip(later.field)
                .map(|(p, q)| line(p, q, fraction)),
            truth: earlier
                .truth
                .zip(later.truth)
                .map(|(p, q)| between(p, q, fraction)),
        }
    }

    fn duration(&self) -> Option<f64> {
        Some(self.length())
    }

    fn describe(&self) -> String {
        let name = self.name.as_deref().unwrap_or("unnamed");
        let truth = self.instants.iter().filter(|i| i.truth.is_some()).count();
        let truth = match truth {
            0 => "without truth",
            n if n == self.instants.len() => "with truth",
            _ => "with truth in parts",
        };
        format!(
            "{} {name}: {} samples in {:.1} s, {truth}",
            self.kind,
            self.samples(),
            self.length()
        )
    }
}

fn line(a: [f64; 3], b: [f64; 3], fraction: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * fraction)
}
