//! A run in a few numbers, for programs that compare runs.

use super::Board;
use super::latency::Latencies;
use crate::time::{SECOND, Ticks};

/// What a board has come to so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Share of the time that the processor is awake, by both ends of the band (0 to 1).
    pub load: (f64, f64),
    /// Share of the time that the sensor's bus is in use (0 to 1).
    pub bus: f64,
    /// From data-ready to the packet in the USB controller's hands, in seconds: median, 99 % and worst. None if no packet
    /// followed a sample.
    pub latency: Option<[f64; 3]>,
    /// The same to the moment at which the host begins to take the packet.
    pub to_host: Option<[f64; 3]>,
    /// The deepest stack in bytes.
    pub stack: u32,
    /// Static RAM in bytes, if the image tells.
    pub ram: Option<usize>,
    /// Flash in bytes.
    pub flash: usize,
    /// Interrupts taken.
    pub interrupts: u64,
}

impl Board {
    /// Begins to measure: what was until now (the start, the set-up of the sensor) does not count.
    pub fn begin_figures(&mut self) {
        let bus = self.chip_quietly().i2c.busy_time();
        self.began = (self.now, self.measure.awake, bus);
        self.latencies.clear();
        self.taken.clear();
    }

    /// The figures since [`Board::begin_figures`], or since power-on.
    pub fn figures(&self) -> Figures {
        let (since, awake, bus) = self.began;
        let span = (self.now - since).max(1) as f64;
        let share = |ticks: Ticks| ticks as f64 / span;
        let now = self.measure.awake;
        let busy = self.shared.chip().i2c.busy_time();
        let seconds = |ticks: Ticks| ticks as f64 / SECOND as f64;
        let percentiles = |times: &Latencies| {
            let percentile = |percent| times.percentile(percent).map(seconds);
            let [median, most, worst] = [50, 99, 100].map(percentile);
            Some([median?, most?, worst?])
        };
        Figures {
            load: (
                share(now.least - awake.least),
                share(now.greatest - awake.greatest),
            ),
            bus: share(busy.saturating_sub(bus)),
            latency: percentiles(&self.latencies),
            to_host: percentiles(&self.taken),
            stack: self.image.stack.saturating_sub(self.measure.stack_low),
            ram: self.image.ram_used(),
            flash: self.image.flash_used(),
            interrupts: self.measure.latencies.iter().map(|of| of.count).sum(),
        }
    }
}
