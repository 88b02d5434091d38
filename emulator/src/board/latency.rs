//! How long a sample is on its way: from the sensor's data-ready to the packet that the program gives the USB controller.
//!
//! Counted once for each new sample that was followed by a packet before the next one was fetched: to the first of them.
//! A program that sends what it had in a queue looks better than it is.

use crate::time::Ticks;

/// The times of a run.
#[derive(Debug, Clone, Default)]
pub struct Latencies {
    times: Vec<Ticks>,
}

impl Latencies {
    /// A sample took this long.
    pub(super) fn push(&mut self, time: Ticks) {
        self.times.push(time);
    }

    /// Forgets those so far, to measure a part of a run.
    pub fn clear(&mut self) {
        self.times.clear();
    }

    /// How many were measured.
    pub fn count(&self) -> usize {
        self.times.len()
    }

    /// What so many per cent of them stay within, 50 for the median and 100 for the worst; `None` if there are none.
    pub fn percentile(&self, percent: u8) -> Option<Ticks> {
        let mut sorted = self.times.clone();
        sorted.sort_unstable();
        let rank = (sorted.len() * usize::from(percent.min(100))).div_ceil(100);
        sorted.get(rank.saturating_sub(1)).copied()
    }
}
