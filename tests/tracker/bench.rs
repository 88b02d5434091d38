//! A tracker that is fed sample by sample and typed at.

#![allow(dead_code)] // Every test file uses its own part of this.

use vrduino::command::Parser;
use vrduino::sensor::{AccelRange, GyroRange, Ranges, RawSample};
use vrduino::tracker::{Health, Tracker};

pub const RANGES: Ranges = Ranges {
    gyro: GyroRange::Dps2000,
    accel: AccelRange::G16,
};
/// 1 g on y. The gyro reads 8 counts, 0.488 °/s, about y when nothing turns.
pub const LEVEL: RawSample = RawSample {
    gyro: [0, 8, 0],
    accel: [0, 2048, 0],
    temperature: 0,
    fresh: true,
};

pub struct Bench {
    pub tracker: Tracker,
    pub health: Health,
    /// Every line with the number of the sample that led to it, from 1.
    pub lines: Vec<(u32, String)>,
    /// Every packet of frames, the same.
    pub frames: Vec<(u32, Vec<u8>)>,
    pub samples: u32,
}

impl Bench {
    pub fn new() -> Self {
        Self {
            tracker: Tracker::new(RANGES),
            health: Health::default(),
            lines: Vec::new(),
            frames: Vec::new(),
            samples: 0,
        }
    }

    /// One that has measured its bias on a level board.
    pub fn started() -> Self {
        let mut bench = Self::new();
        bench.feed(1000, |_| LEVEL);
        bench.lines.clear();
        bench
    }

    pub fn feed(&mut self, samples: u32, raw: impl Fn(u32) -> RawSample) {
        for i in 0..samples {
            self.samples += 1;
            let (at, lines) = (self.samples, &mut self.lines);
            let frame = self
                .tracker
                .update(&raw(i), None, &self.health, &mut |line| {
                    lines.push((at, line.to_string()));
                });
            self.frames.extend(frame.map(|frame| (at, frame.to_vec())));
        }
    }

    pub fn press(&mut self, key: u8) {
        self.type_in(&[key]);
    }

    /// What the tracker answers lands in the lines.
    pub fn type_in(&mut self, bytes: &[u8]) {
        let mut parser = Parser::new();
        let (at, lines) = (self.samples, &mut self.lines);
        for command in bytes.iter().filter_map(|&byte| parser.push(byte)) {
            self.tracker
                .command(command, &mut |line| lines.push((at, line.to_string())));
        }
    }

    /// The answer to one line.
    pub fn ask(&mut self, line: &str) -> &str {
        let before = self.lines.len();
        self.type_in(format!("{line}\n").as_bytes());
        assert_eq!(self.lines.len(), before + 1, "one answer to {line:?}");
        self.lines[before].1.as_str()
    }

    pub fn texts(&self) -> Vec<&str> {
        self.lines.iter().map(|(_, line)| line.as_str()).collect()
    }

    pub fn tagged(&self, tag: &str) -> Vec<&str> {
        let mut texts = self.texts();
        texts.retain(|line| line.starts_with(tag));
        texts
    }
}

/// Turned in the hand: 60 °/s back and forth about x.
pub fn handled(i: u32) -> RawSample {
    let swing = (f64::from(i) * 0.01).sin();
    RawSample {
        gyro: [(swing * 983.0) as i16, 0, 0],
        accel: [(swing * 300.0) as i16, 2048, 0],
        temperature: 0,
        fresh: true,
    }
}
