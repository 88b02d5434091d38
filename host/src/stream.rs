//! The stream as samples: the library's decoder, with the moment, the delay and the losses of each.

mod clock;

pub mod condition;

mod delay;

mod statistics;

use nalgebra::UnitQuaternion;
use vrduino::wire::Status;
use vrduino::wire::decoder::{Decoder, Event, Received};
use vrduino::wire::frame::Counts;

use clock::Clock;
use delay::Delay;
use statistics::Statistics;
pub use statistics::{Percentiles, Report};

/// An orientation as it came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// When it was measured, in s: on the device's clock if [`Sample::sequence`] is known, which goes
    /// on over its wraps and starts anew with the board; else when it came, on the source's clock.
    pub time: f64,
    /// When it came, in s on the source's clock.
    pub arrival: f64,
    /// Body to world, y up, of unit length.
    pub orientation: UnitQuaternion<f64>,
    /// Its number, if the stream has numbers.
    pub sequence: Option<u16>,
    /// How far to be trusted, if the stream says so.
    pub status: Option<Status>,
    /// By how much more it was late than the fastest, in s; unknown without the device's time.
    pub delay: Option<f64>,
    /// Before it the board has started again, or the connection: times begin anew.
    pub is_first: bool,
}

/// What the sensor's registers held (`:stream counts`), of which the sample before it was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Registers {
    /// The number of that sample.
    pub sequence: u16,
    /// As the sensor had them.
    pub counts: Counts,
}

/// What a stream is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// An orientation.
    Sample(Sample),
    /// What it was made of.
    Registers(Registers),
    /// Any other line of text, without its end.
    Line(String),
}

/// Reads the stream.
#[derive(Debug, Default)]
pub struct Stream {
    decoder: Decoder,
    clock: Clock,
    delay: Delay,
    statistics: Statistics,
    /// Nothing has come over this connection yet.
    connected_again: bool,
}

impl Stream {
    /// At its beginning.
    pub fn new() -> Self {
        Self {
            connected_again: true,
            ..Self::default()
        }
    }

    /// What comes from here on comes over a new connection: the counts go on, times begin anew.
    pub fn reconnect(&mut self) {
        if !std::mem::replace(&mut self.connected_again, true) {
            self.statistics.pause(self.decoder.losses());
            self.decoder = Decoder::new();
        }
    }

    /// Takes bytes that came `at` so many s on the source's clock.
    pub fn take(&mut self, at: f64, bytes: &[u8], items: &mut Vec<Item>) {
        for &byte in bytes {
            match self.decoder.push(byte) {
                Some(Event::Orientation(received)) => {
                    let restarts = self.decoder.losses().restarts;
                    let sample = self.sample(at, received, restarts);
                    items.push(Item::Sample(sample));
                }
                Some(Event::Counts(counts, stamp)) => items.push(Item::Registers(Registers {
                    sequence: stamp.sequence,
                    counts,
                })),
                Some(Event::Text(line)) => items.push(Item::Line(line.to_owned())),
                // From a newer board; it means nothing here.
                Some(Event::Unknown(_)) | None => {}
            }
        }
    }

    fn sample(&mut self, at: f64, received: Received, restarts: u32) -> Sample {
        let Received {
            orientation,
            stamp,
            status,
            ..
        } = received;
        let again = std::mem::take(&mut self.connected_again);
        let is_first = self.statistics.has_restarted(restarts) || again;
        if is_first {
            self.clock = Clock::default();
            self.delay = Delay::default();
        }
        let device = stamp.map(|stamp| self.clock.seconds(stamp.micros));
        let delay = device.map(|time| self.delay.of(time, at));
        self.statistics.count(at, delay);
        Sample {
            time: device.unwrap_or(at),
            arrival: at,
            orientation,
            sequence: stamp.map(|stamp| stamp.sequence),
            status,
            delay,
            is_first,
        }
    }

    /// How it has gone until `now`, in s on the source's clock.
    pub fn report(&self, now: f64) -> Report {
        self.statistics.report(now, self.decoder.losses())
    }
}
