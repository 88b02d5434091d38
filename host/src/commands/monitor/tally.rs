//! What has come since the beginning.

use crate::hub::answer;
use crate::stream::condition::Condition;
use crate::stream::{Item, Percentiles};

/// Counts it.
#[derive(Debug, Default)]
pub struct Tally {
    samples: u64,
    /// Since the last line that was printed.
    pub recent: Condition,
    /// Since the beginning.
    pub all: Condition,
    delays: Delays,
    /// The last line that was no orientation and no answer.
    pub other: Option<String>,
    warnings: u64,
}

impl Tally {
    /// Takes it; gives the line if it is the board's warning or error.
    pub fn take<'a>(&mut self, item: &'a Item) -> Option<&'a str> {
        match item {
            Item::Sample(sample) => {
                self.samples += 1;
                self.recent.take(sample.status);
                self.all.take(sample.status);
                if let Some(delay) = sample.delay {
                    self.delays.take(delay);
                }
                None
            }
            Item::Registers(_) => None,
            Item::Line(line) => {
                let answer = answer::is_one(line);
                if !answer {
                    self.other = Some(line.clone());
                }
                let warns = ["warning:", "error:"]
                    .iter()
                    .any(|word| line.starts_with(word));
                self.warnings += u64::from(warns);
                warns.then_some(line)
            }
        }
    }

    /// Orientations.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Lines in which the board warned of something.
    pub fn warnings(&self) -> u64 {
        self.warnings
    }

    /// Of all delays.
    pub fn delay(&self) -> Option<Percentiles> {
        self.delays.percentiles()
    }
}

/// Delays of hours, in little room: how many lie in each of many classes, a per cent wide.
#[derive(Debug, Default)]
struct Delays {
    classes: Vec<u64>,
    count: u64,
    max: f64,
}

/// The first class ends here (s).
const LEAST: f64 = 1e-6;

/// Each is so much wider than the one before.
const STEP: f64 = 1.01;

/// Beyond an hour nothing is told apart.
const CLASSES: usize = 2200;

impl Delays {
    fn take(&mut self, delay: f64) {
        let class = ((delay / LEAST).max(1.0).ln() / STEP.ln()).ceil() as usize;
        let class = class.min(CLASSES);
        if self.classes.len() <= class {
            self.classes.resize(class + 1, 0);
        }
        self.classes[class] += 1;
        self.count += 1;
        self.max = self.max.max(delay);
    }

    fn percentiles(&self) -> Option<Percentiles> {
        (self.count > 0).then(|| Percentiles {
            p50: self.below(0.5),
            p99: self.below(0.99),
            max: self.max,
        })
    }

    /// Below which this part of them lies.
    fn below(&self, part: f64) -> f64 {
        let wanted = (self.count as f64 * part).ceil();
        let mut seen = 0;
        for (class, count) in self.classes.iter().enumerate() {
            seen += count;
            if seen as f64 >= wanted {
                return (LEAST * STEP.powi(class as i32)).min(self.max);
            }
        }
        self.max
    }
}

#[cfg(test)]
mod tests {
    use super::Delays;

    #[test]
    fn the_percentiles_of_many_delays_are_right_within_a_per_cent() {
        let mut delays = Delays::default();
        assert!(delays.percentiles().is_none());
        for i in 1..=10_000 {
            delays.take(f64::from(i) * 1e-6);
        }
        delays.take(7e9);
        delays.take(0.0);
        let percentiles = delays.percentiles().expect("some were taken");
        assert!(
            (percentiles.p50 / 5e-3 - 1.0).abs() < 0.011,
            "{percentiles:?}"
        );
        assert!(
            (percentiles.p99 / 9.9e-3 - 1.0).abs() < 0.011,
            "{percentiles:?}"
        );
        assert_eq!(percentiles.max, 7e9);
    }
}
