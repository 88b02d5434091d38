//! Recordings to test with.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

use nalgebra::{Quaternion, UnitQuaternion};
use vrduino::sensor::RawSample;
use vrduino::sensor::magnetometer::{RawField, Resolution};
use vrduino::wire::Status;
use vrduino::wire::frame::Counts;
use vrduino_host::recording::{Entry, Head, Reader, Remark, Row, Voice, Writer};
use vrduino_host::stream::Sample;

use crate::program::vrduino;

/// A file that is gone after the test.
pub struct Scratch(pub PathBuf);

impl Scratch {
    /// Its own, even if several tests call theirs so.
    pub fn new(name: &str) -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let (stem, ending) = name.split_once('.').unwrap_or((name, ""));
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let program = std::process::id();
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        Self(folder.join(format!("recordings-{stem}-{program}-{count}.{ending}")))
    }

    pub fn with(name: &str, content: impl AsRef<[u8]>) -> Self {
        let scratch = Self::new(name);
        fs::write(&scratch.0, content).expect("a file is written");
        scratch
    }

    pub fn path(&self) -> &str {
        self.0.to_str().expect("plain letters")
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// Four seconds of the emulated board, registers included, carried through quarter turns from 3 s on.
pub fn turns() -> &'static str {
    static FILE: OnceLock<&str> = OnceLock::new();
    FILE.get_or_init(|| {
        // One for all of them: it stays, and is written over by the next run.
        let path = concat!(env!("CARGO_TARGET_TMPDIR"), "/recordings-turns.csv");
        let words = "record --emulate --motion turns --counts --seconds 4 --force";
        let words: Vec<_> = words.split(' ').chain([path]).collect();
        vrduino(&words).expect(0).said("none missing");
        path
    })
}

/// Everything in it, and that it is whole.
pub fn entries(path: &str) -> Vec<Entry> {
    let (entries, warning) = read(path);
    assert_eq!(warning, None);
    entries
}

/// What of it is whole, and what is said if that is not all.
pub fn read(path: &str) -> (Vec<Entry>, Option<String>) {
    let mut reader = Reader::open(Path::new(path)).unwrap_or_else(|failure| panic!("{failure}"));
    let mut entries = Vec::new();
    while let Some(entry) = reader.read().unwrap_or_else(|failure| panic!("{failure}")) {
        entries.push(entry);
    }
    let warning = reader.warning();
    (entries, warning)
}

pub fn samples(entries: &[Entry]) -> Vec<Sample> {
    let rows = entries.iter().filter_map(|entry| match entry {
        Entry::Row(row) => Some(row.sample),
        Entry::Remark(_) => None,
    });
    rows.collect()
}

/// A recording of these, in a file.
pub fn write(name: &str, head: &Head, entries: &[Entry]) -> Scratch {
    let scratch = Scratch::new(name);
    let mut writer = Writer::create(&scratch.0, true).expect("a file");
    writer.begin(head).expect("a head");
    for entry in entries {
        writer.write(entry).expect("an entry");
    }
    writer.finish().expect("an end");
    scratch
}

/// At this time, `degrees` to the left.
pub fn turned(time: f64, sequence: u16, degrees: f64) -> Sample {
    let half = degrees.to_radians() / 2.0;
    let q = Quaternion::new(half.cos(), 0.0, half.sin(), 0.0);
    Sample {
        time,
        arrival: time + 0.003,
        orientation: UnitQuaternion::new_normalize(q),
        sequence: Some(sequence),
        status: Some(Status::default()),
        delay: Some(0.0001),
        is_first: sequence == 0,
    }
}

pub fn row(sample: Sample) -> Entry {
    let registers = None;
    Entry::Row(Row { sample, registers })
}

/// Anything, but always the same.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        // xorshift64* (Vigna, 2016).
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// From −1 to 1.
    pub fn number(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn flag(&mut self) -> bool {
        self.bits() >> 63 == 1
    }

    fn word(&mut self) -> i16 {
        (self.bits() >> 48) as i16
    }

    fn words(&mut self) -> [i16; 3] {
        [self.word(), self.word(), self.word()]
    }

    /// A sample with or without a number, a status, a delay and registers.
    pub fn entry(&mut self, time: f64, is_first: bool) -> Entry {
        if self.bits().is_multiple_of(16) {
            let text = format!("warning: {}", self.bits());
            let voice = if self.flag() {
                Voice::Board
            } else {
                Voice::Recorder
            };
            return Entry::Remark(Remark::new(time, voice, &text));
        }
        let mut component = || self.number() * 0.1_f64.powi((self.bits() % 12) as i32);
        let q = Quaternion::new(component(), component(), component(), component());
        let status = self
            .flag()
            .then(|| Status::from_byte((self.bits() >> 56) as u8));
        let fresh = !status.unwrap_or_default().repeated;
        let field = self.flag().then(|| RawField {
            counts: self.words(),
            resolution: Resolution::Bits16,
            overflow: false,
        });
        let sample = RawSample {
            gyro: self.words(),
            accel: self.words(),
            temperature: self.word(),
            fresh,
        };
        let registers = self.flag().then_some(Counts { sample, field });
        let sample = Sample {
            time,
            arrival: time + 0.25,
            orientation: UnitQuaternion::try_new(q, 1e-30).unwrap_or_default(),
            sequence: self.flag().then(|| (self.bits() >> 48) as u16),
            status,
            delay: self.flag().then(|| (self.bits() % 4096) as f64 * 1e-6),
            is_first,
        };
        Entry::Row(Row { sample, registers })
    }
}

/// The same, but for what is not written of times.
pub fn assert_same(one: &[Entry], other: &[Entry]) {
    assert_eq!(one.len(), other.len());
    let near = |a: f64, b: f64| (a - b).abs() < 0.6e-6;
    for (one, other) in one.iter().zip(other) {
        let same = match (one, other) {
            (Entry::Remark(a), Entry::Remark(b)) => {
                near(a.at, b.at) && a.voice == b.voice && a.text == b.text
            }
            (Entry::Row(a), Entry::Row(b)) => {
                let delays = match (a.sample.delay, b.sample.delay) {
                    (Some(a), Some(b)) => near(a, b),
                    (a, b) => a == b,
                };
                let rest = Sample {
                    time: b.sample.time,
                    arrival: b.sample.arrival,
                    delay: b.sample.delay,
                    ..a.sample
                };
                delays
                    && near(a.sample.time, b.sample.time)
                    && near(a.sample.arrival, b.sample.arrival)
                    && rest == b.sample
                    && a.registers == b.registers
            }
            _ => false,
        };
        assert!(same, "{one:?}\n{other:?}");
    }
}
