//! A board that boots the image, and what its host reads.

use std::path::PathBuf;
use std::sync::OnceLock;

use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::firmware::{self, BuildOptions};
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::Motion;
use vrduino_emulator::motion::rotation::angle_between;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::time::{self, MILLISECOND};

pub const X: [f64; 3] = [1.0, 0.0, 0.0];
pub const Y: [f64; 3] = [0.0, 1.0, 0.0];
pub const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// A printed component is off by half a digit in the third decimal at most; on a quaternion that is
/// 0.11° in the worst case.
pub const PRINTED: f64 = 0.11;

/// What is typed for six decimals.
pub const SIX_DECIMALS: &[u8] = b":decimals 6\n";

pub fn image() -> Image {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    let path = PATH.get_or_init(|| {
        firmware::build(BuildOptions { quiet: true }).expect("the firmware builds")
    });
    Image::open(path).expect("the emulator accepts the firmware")
}

/// A board that runs, and what its host has read.
pub struct Run {
    pub board: Board,
    pub text: String,
    /// How much of the text has been taken apart.
    read: usize,
    /// Each orientation with the time at which the host had it.
    pub orientations: Vec<(f64, [f64; 4])>,
}

impl Run {
    pub fn with(setup: Setup) -> Run {
        Run {
            board: Board::new(image(), setup),
            text: String::new(),
            read: 0,
            orientations: Vec::new(),
        }
    }

    pub fn moved_by(motion: impl Motion + 'static) -> Run {
        Run::with(Setup::new(Box::new(motion)))
    }

    pub fn still() -> Run {
        Run::moved_by(Turns::new(1e6, 0.0))
    }

    pub fn seconds(&mut self, seconds: f64) {
        let until = self.board.now() + time::ticks(seconds);
        while self.board.now() < until {
            self.board.run(MILLISECOND);
            if let Some(stop) = self.board.stop() {
                panic!("the program stepped into a trap:\n{stop}\n{}", self.text);
            }
            let received = self.board.chip_quietly().host.take_received();
            let now = time::seconds(self.board.now());
            self.text
                .push_str(std::str::from_utf8(&received).expect("the stream is text"));
            // A line counts once its end is there.
            while let Some(end) = self.text[self.read..].find('\n') {
                let line = &self.text[self.read..self.read + end];
                self.orientations.extend(quaternion(line).map(|q| (now, q)));
                self.read += end + 1;
            }
        }
    }

    /// Boots for a second, asks for six decimals, and goes on.
    pub fn with_six_decimals(&mut self, seconds: f64) {
        self.seconds(1.0);
        self.board.chip().host.send(SIX_DECIMALS);
        self.seconds(seconds);
    }

    /// Forgets the text so far, to wait for something new.
    pub fn forget(&mut self) {
        self.text.drain(..self.read);
        self.read = 0;
    }

    pub fn wait_for(&mut self, text: &str, seconds: f64) {
        let until = self.board.now() + time::ticks(seconds);
        while !self.text.contains(text) {
            assert!(
                self.board.now() < until,
                "no {text:?} within {seconds} s, but:\n{}\n{:?}",
                self.text,
                self.board.take_events()
            );
            self.seconds(0.01);
        }
    }

    pub fn last(&self) -> [f64; 4] {
        self.orientations.last().expect("there are orientations").1
    }

    pub fn variable(&self, name: &str) -> u32 {
        self.board
            .variable(name)
            .expect("the image has this symbol")
    }
}

/// The components of a QC line, if it is a whole one.
pub fn quaternion(line: &str) -> Option<[f64; 4]> {
    let numbers: Vec<f64> = line
        .strip_prefix("QC ")?
        .split(' ')
        .map(|n| n.parse().unwrap())
        .collect();
    let q: [f64; 4] = numbers.try_into().expect("four components");
    let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    assert!((norm - 1.0).abs() <= 0.002, "|q| = {norm} in {line:?}");
    Some(q)
}

pub fn degrees_between(a: [f64; 4], b: [f64; 4]) -> f64 {
    angle_between(a, b).to_degrees()
}
