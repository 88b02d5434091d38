//! How it goes: a bar in a terminal, a line now and then elsewhere.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use indicatif::{DecimalBytes, ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::tally::Tally;

/// Between two lines where there is no terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(5);

/// Between two pictures of the bar.
const BETWEEN_PICTURES: Duration = Duration::from_millis(100);

/// Shows how it goes, on standard error.
#[derive(Debug)]
pub struct Progress {
    bar: Option<ProgressBar>,
    total: Option<f64>,
    shown: Instant,
}

impl Progress {
    /// Until so many seconds are recorded, or without end.
    pub fn new(total: Option<f64>) -> Self {
        let bar = io::stderr().is_terminal().then(|| {
            let template = match total {
                Some(_) => "{bar:30} {msg}",
                None => "{spinner} {msg}",
            };
            // In ms: a bar moves in whole steps.
            let length = total.map(|seconds| (seconds * 1e3) as u64);
            let bar = ProgressBar::with_draw_target(length, ProgressDrawTarget::stderr());
            // A template that is no good would be noticed at once; without it the bar is a plainer one.
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar.set_message("waiting for samples, Ctrl-C ends");
            bar
        });
        Self {
            bar,
            total,
            shown: Instant::now(),
        }
    }

    /// Something has to be said.
    pub fn say(&self, sentence: &str) {
        match &self.bar {
            Some(bar) => bar.println(sentence),
            // Where nobody can read it, it need not be said.
            None => drop(writeln!(io::stderr(), "{sentence}")),
        }
    }

    /// So much there is; to be called often.
    pub fn show(&mut self, tally: &Tally, rate: f64, bytes: u64) {
        let between = match self.bar {
            Some(_) => BETWEEN_PICTURES,
            None => BETWEEN_LINES,
        };
        if tally.samples == 0 {
            self.shown = Instant::now();
        }
        if self.shown.elapsed() < between {
            return;
        }
        self.shown = Instant::now();
        let seconds = tally.seconds();
        let of_total = match self.total {
            Some(total) => format!("{seconds:.1} of {total} s"),
            None => format!("{seconds:.1} s"),
        };
        let (samples, missing, size) = (tally.samples, tally.missing, DecimalBytes(bytes));
        let message =
            format!("{of_total}, {samples} samples, {rate:.0} a second, {missing} missing, {size}");
        match &self.bar {
            Some(bar) => {
                bar.set_message(message);
                match self.total {
                    Some(_) => bar.set_position((seconds * 1e3) as u64),
                    None => bar.tick(),
                }
            }
            None => self.say(&message),
        }
    }

    /// It is over.
    pub fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
