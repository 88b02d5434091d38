//! A board with a sketch in its flash, and what its host reads.

use std::path::Path;

use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::cpu::Pace;
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::time::{self, MILLISECOND, SECOND};
use vrduino_emulator::witness::{Stop, Trap};

/// A board that runs a sketch.
pub struct Bench {
    image: Image,
    pub board: Board,
    pub text: String,
}

impl Bench {
    pub fn new(elf: &Path) -> Bench {
        let image = Image::open(elf).expect("the emulator accepts the sketch");
        Bench::with(image, Pace::default(), &[])
    }

    fn with(image: Image, pace: Pace, allowed: &[Trap]) -> Bench {
        let mut still = Setup::new(Box::new(Turns::new(1e6, 0.0))).allowing(allowed);
        still.pace = pace;
        Bench {
            image: image.clone(),
            board: Board::new(image, still),
            text: String::new(),
        }
    }

    /// A fresh board with the same sketch, that goes on after some traps.
    pub fn again(&self, allowed: &[Trap]) -> Bench {
        self.at_pace(Pace::default(), allowed)
    }

    /// The same, by this end of the cycle band.
    pub fn at_pace(&self, pace: Pace, allowed: &[Trap]) -> Bench {
        Bench::with(self.image.clone(), pace, allowed)
    }

    /// Why the board stops after `key` was typed into a sketch that is ready.
    pub fn stop_after(mut self, key: char) -> Stop {
        self.wait_for("ready", 3.0);
        self.type_in(&key.to_string());
        self.board.run(SECOND / 2);
        let stop = self.board.stop().cloned();
        stop.unwrap_or_else(|| {
            panic!(
                "{key} did not stop the board; {:?}",
                self.board.take_events()
            )
        })
    }

    /// Runs for a while. A trap ends the test.
    pub fn seconds(&mut self, seconds: f64) {
        let until = self.board.now() + time::ticks(seconds);
        while self.board.now() < until {
            self.board.run(MILLISECOND);
            let received = self.board.chip_quietly().host.take_received();
            self.text.push_str(&String::from_utf8_lossy(&received));
            if let Some(stop) = self.board.stop() {
                panic!("{stop}\nafter:\n{}", self.text);
            }
        }
    }

    /// Runs until the sketch has printed `text`; returns what follows it on its line.
    pub fn wait_for(&mut self, text: &str, seconds: f64) -> String {
        let until = self.board.now() + time::ticks(seconds);
        loop {
            if let Some((_, rest)) = self.text.split_once(text)
                && let Some((line, _)) = rest.split_once('\n')
            {
                return line.trim().to_owned();
            }
            assert!(
                self.board.now() < until,
                "no {text:?} within {seconds} s, but:\n{}\n{:?}",
                self.text,
                self.board.take_events()
            );
            self.seconds(0.005);
        }
    }

    /// The number that follows `text` on its line.
    pub fn number(&mut self, text: &str, seconds: f64) -> f64 {
        let rest = self.wait_for(text, seconds);
        let first = rest.split_whitespace().next().unwrap_or_default();
        first
            .parse()
            .unwrap_or_else(|_| panic!("{text:?} is followed by {rest:?}, which is no number"))
    }

    /// The numbers that follow `text` on its line.
    pub fn numbers(&mut self, text: &str, seconds: f64) -> Vec<f64> {
        let rest = self.wait_for(text, seconds);
        rest.split_whitespace()
            .map(|word| {
                word.parse()
                    .unwrap_or_else(|_| panic!("{rest:?} holds {word:?}, which is no number"))
            })
            .collect()
    }

    /// Forgets what was printed.
    pub fn forget(&mut self) {
        self.text.clear();
    }

    pub fn type_in(&mut self, text: &str) {
        self.board.chip().host.send(text.as_bytes());
    }
}
