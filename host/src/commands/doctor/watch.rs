//! Listens for a while: first to who it is, then to what it streams.

use std::sync::Arc;
use std::time::{Duration, Instant};

use vrduino::calibration::{Stillness, Verdict};
use vrduino::imu::RANGES;
use vrduino::wire::decoder::{Decoder, Event};

use crate::hub::{Hub, Status, Subscription, Update};
use crate::patience::Patience;
use crate::stream::{Item, Sample};

/// For who it is: a board that says nothing is asked five times, and its start takes a second.
const INTRODUCTION: Duration = Duration::from_secs(8);

/// For what it streams, on the board's clock (s): drift is taken over three of them.
const STREAM: f64 = 3.5;

/// In seconds of this computer: where nothing more comes, and where it comes slowly.
const STANDSTILL: Duration = Duration::from_secs(6);
const LIMIT: Duration = Duration::from_secs(90);

/// Lines that are kept.
const LINES: usize = 200;

/// What was seen.
#[derive(Debug)]
pub struct Seen {
    /// How things stood at the end.
    pub status: Arc<Status>,
    /// The first lines, whatever they said.
    pub lines: Vec<String>,
    /// Bytes altogether.
    pub bytes: u64,
    /// Orientations, also those in another program's lines.
    pub orientations: u64,
    /// Of the stream of counts: the first sample and the last.
    pub ends: Option<[Sample; 2]>,
    /// How many there were from the first to the last, the first left out.
    pub samples: u64,
    /// And how many of them repeated the one before, for the sensor had nothing new.
    pub repeated: u64,
    /// By which the length of a quaternion was off 1, at most.
    pub length_error: f64,
    /// What the still seconds said: force in m/s².
    pub rests: Vec<f32>,
    /// Seconds in which it moved.
    pub moved: u32,
    /// With a field in them.
    pub fields: u64,
}

/// Watches.
pub fn watch(hub: &Hub, updates: &Subscription) -> Seen {
    let mut watch = Watch::new(hub.status());
    let began = Instant::now();
    let introduced = |status: &Status| {
        let stream = status.stream.as_deref().unwrap_or_default();
        status.version.is_some() && stream.starts_with("counts") && status.settings.len() > 2
    };
    // It may say that its sensor is missing, and nothing else.
    while began.elapsed() < INTRODUCTION && !introduced(&watch.seen.status) {
        watch.take(updates.next(Duration::from_millis(50)), false);
        // A stranger has been asked often enough.
        if watch.seen.status.trouble.is_some() {
            break;
        }
    }
    if watch.seen.status.version.is_some() {
        let began = Instant::now();
        let (mut standing, mut before) = (Patience::new(), 0.0);
        while watch.seconds() < STREAM && began.elapsed() < LIMIT && standing.look() < STANDSTILL {
            watch.take(updates.next(Duration::from_millis(50)), true);
            if watch.seconds() != before {
                before = watch.seconds();
                standing.renew();
            }
        }
        watch.seen.status = hub.status();
    }
    watch.seen
}

struct Watch {
    seen: Seen,
    /// For what the stream does not pass on: the length as it was sent.
    decoder: Decoder,
    stillness: Stillness,
}

impl Watch {
    fn new(status: Arc<Status>) -> Self {
        Self {
            seen: Seen {
                status,
                lines: Vec::new(),
                bytes: 0,
                orientations: 0,
                ends: None,
                samples: 0,
                repeated: 0,
                length_error: 0.0,
                rests: Vec::new(),
                moved: 0,
                fields: 0,
            },
            decoder: Decoder::new(),
            stillness: Stillness::new(RANGES),
        }
    }

    /// Of the stream, on the board's clock.
    fn seconds(&self) -> f64 {
        let span = |[first, last]: &[Sample; 2]| last.time - first.time;
        self.seen.ends.as_ref().map_or(0.0, span)
    }

    fn take(&mut self, update: Option<Update>, streaming: bool) {
        match update {
            Some(Update::Status(status)) => self.seen.status = status,
            Some(Update::Bytes(bytes)) => self.measure(&bytes),
            Some(Update::Stream(items)) => {
                for item in items.iter() {
                    self.note(item, streaming);
                }
            }
            Some(Update::Truth(_) | Update::Ended(_)) | None => {}
        }
    }

    fn measure(&mut self, bytes: &[u8]) {
        self.seen.bytes += bytes.len() as u64;
        for &byte in bytes {
            if let Some(Event::Orientation(received)) = self.decoder.push(byte)
                && received.status.is_some()
            {
                let length = received
                    .components
                    .map(|c| c * c)
                    .iter()
                    .sum::<f64>()
                    .sqrt();
                let error = (length - 1.0).abs();
                self.seen.length_error = self.seen.length_error.max(error);
            }
        }
    }

    fn note(&mut self, item: &Item, streaming: bool) {
        match item {
            Item::Line(line) => {
                if self.seen.lines.len() < LINES {
                    self.seen.lines.push(line.clone());
                }
            }
            Item::Sample(sample) => {
                self.seen.orientations += 1;
                if streaming && sample.status.is_some() {
                    self.count(sample);
                }
            }
            Item::Registers(registers) if streaming => {
                let sample = &registers.counts.sample;
                self.seen.fields += u64::from(registers.counts.field.is_some());
                match self.stillness.push(sample) {
                    Verdict::Collecting => {}
                    Verdict::Still(rest) => self.seen.rests.push(rest.force.m_per_s2().norm()),
                    Verdict::Moved => self.seen.moved += 1,
                }
            }
            Item::Registers(_) => {}
        }
    }

    fn count(&mut self, sample: &Sample) {
        let repeated = sample.status.is_some_and(|status| status.repeated);
        match &mut self.seen.ends {
            Some([_, last]) if !sample.is_first => {
                *last = *sample;
                self.seen.samples += 1;
                self.seen.repeated += u64::from(repeated);
            }
            ends => {
                *ends = Some([*sample; 2]);
                self.seen.samples = 0;
                self.seen.repeated = 0;
            }
        }
    }
}
