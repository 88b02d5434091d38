//! How a stream goes: how many, how late, and what was lost.

use std::collections::VecDeque;
use std::fmt;

use vrduino::wire::decoder::Losses;

/// Over which the rate and the delays are taken (s).
const WINDOW: f64 = 2.0;

/// Of the delays in a window.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Percentiles {
    /// Half of them were less (s).
    pub p50: f64,
    /// Ninety-nine of a hundred were less (s).
    pub p99: f64,
    /// The worst (s).
    pub max: f64,
}

/// In milliseconds, to hundredths where that is more than noise.
impl fmt::Display for Percentiles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = |seconds: f64| {
            let ms = seconds * 1e3;
            let digits = if ms < 10.0 { 2 } else { 0 };
            format!("{ms:.digits$}")
        };
        let Self { p50, p99, max } = *self;
        write!(f, "p50 {} p99 {} max {}", ms(p50), ms(p99), ms(max))
    }
}

/// How a stream goes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Orientations since the beginning.
    pub samples: u64,
    /// Orientations a second, of late.
    pub rate: f64,
    /// How much later than the fastest they came, of late; unknown without the device's time.
    pub delay: Option<Percentiles>,
    /// Orientations that never came, by their numbers.
    pub missing: u64,
    /// Lines and frames with a wrong checksum.
    pub damaged: u64,
    /// What was no line and no frame.
    pub malformed: u64,
    /// Bytes that were part of nothing.
    pub bytes: u64,
    /// Times the board has started again.
    pub restarts: u64,
    /// Times the connection was made anew.
    pub reconnections: u64,
}

/// Counts them.
#[derive(Debug, Default)]
pub struct Statistics {
    /// Without what the present connection has lost.
    total: Report,
    /// When the latest came, and their delays.
    recent: VecDeque<(f64, Option<f64>)>,
    /// When the first of this connection came.
    began: Option<f64>,
    restarts: u32,
}

impl Statistics {
    /// An orientation came.
    pub fn count(&mut self, at: f64, delay: Option<f64>) {
        self.total.samples += 1;
        self.began.get_or_insert(at);
        self.recent.push_back((at, delay));
        while self
            .recent
            .front()
            .is_some_and(|&(first, _)| first < at - WINDOW)
        {
            self.recent.pop_front();
        }
    }

    /// Whether the board has started again since this was last asked.
    pub fn has_restarted(&mut self, restarts: u32) -> bool {
        restarts != std::mem::replace(&mut self.restarts, restarts)
    }

    /// The connection is made anew; the one before has lost so much.
    pub fn pause(&mut self, losses: &Losses) {
        self.total = self.with(losses);
        self.total.reconnections += 1;
        self.recent.clear();
        self.began = None;
        self.restarts = 0;
    }

    fn with(&self, losses: &Losses) -> Report {
        Report {
            missing: self.total.missing + u64::from(losses.missing),
            damaged: self.total.damaged + u64::from(losses.damaged),
            malformed: self.total.malformed + u64::from(losses.malformed),
            bytes: self.total.bytes + losses.bytes,
            restarts: self.total.restarts + u64::from(losses.restarts),
            ..self.total
        }
    }

    /// How it has gone until `now`.
    pub fn report(&self, now: f64, losses: &Losses) -> Report {
        let recent = self.recent.iter().filter(|&&(at, _)| at > now - WINDOW);
        let mut delays: Vec<f64> = recent.clone().filter_map(|&(_, delay)| delay).collect();
        delays.sort_by(f64::total_cmp);
        let of = |part: f64| delays[((delays.len() - 1) as f64 * part).round() as usize];
        let delay = (!delays.is_empty()).then(|| Percentiles {
            p50: of(0.5),
            p99: of(0.99),
            max: of(1.0),
        });
        Report {
            rate: self.rate(now),
            delay,
            ..self.with(losses)
        }
    }

    /// By the span in which they came; a beginning is not taken for a slow stream.
    fn rate(&self, now: f64) -> f64 {
        let recent = self
            .recent
            .iter()
            .filter(|&&(at, _)| at > now - WINDOW)
            .count();
        let span = self.began.map_or(WINDOW, |began| (now - began).min(WINDOW));
        // Of one packet nothing can be said.
        if span < 0.05 {
            0.0
        } else {
            recent as f64 / span
        }
    }
}
