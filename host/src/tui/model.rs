//! What is known, and what the viewer has chosen to see.

use std::collections::VecDeque;
use std::sync::Arc;

use nalgebra::{Point3, Quaternion, UnitQuaternion};
use vrduino::units::Millimetres;
use vrduino::view::eyes::InterpupillaryDistance;
use vrduino::view::head_neck::HeadNeck;
use vrduino::view::mounting::Mounting;
use vrduino::view::viewer::Viewer;

use super::strips::Strips;
use crate::hub::{State, Status, Update, answer};
use crate::source::Truth;
use crate::stream::condition::Condition;
use crate::stream::{Item, Sample};

/// Lines of the board's that are kept.
const LINES: usize = 60;

/// Truth and sample further apart (s) are not compared.
const TOGETHER: f64 = 0.005;

/// l_n and l_h of algorithm 3 (mm): the neck's joint is so far below and behind the eyes.
const NECK: [f64; 2] = [150.0, 100.0];

/// How high the eyes of one who sits are (mm).
const EYES: f64 = 1200.0;

/// Everything that is drawn.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// How things are.
    pub status: Arc<Status>,
    /// The latest orientation that is shown.
    pub sample: Option<Sample>,
    /// How far it is from how the emulated sensor really stands (rad).
    pub off: Option<f64>,
    /// The angles of the last seconds.
    pub strips: Strips,
    /// The board's lines, and what was typed.
    pub lines: VecDeque<String>,
    /// Whether the picture stands.
    pub is_paused: bool,
    /// Whether two eyes look through the headset, instead of one at the board.
    pub is_stereo: bool,
    /// Whether the head turns about the neck (algorithm 3), or about the eyes (algorithm 2).
    pub has_neck: bool,
    /// Whether the board is taped to the headset's front, turned round.
    pub is_turned_round: bool,
    /// Whether the keys are explained.
    pub shows_help: bool,
    /// What the last key came to, if it came to nothing.
    pub notice: Option<String>,
    /// Where the hand holds the emulated sensor: yaw and pitch (°).
    pub hand: [f64; 2],
    condition: Condition,
    condition_before: Condition,
    /// Answers of the board's to what was typed here that are still to come.
    pub(super) awaited: u32,
}

impl Model {
    /// Before anything has come.
    pub fn new() -> Self {
        Self {
            has_neck: true,
            ..Self::default()
        }
    }

    /// Takes what has happened.
    pub fn take(&mut self, update: &Update) {
        match update {
            Update::Status(status) => self.learn(status),
            Update::Stream(items) => items.iter().for_each(|item| self.read(item)),
            Update::Truth(truth) => self.compare(truth),
            // The same is in the bytes' items and in the status.
            Update::Bytes(_) | Update::Ended(_) => {}
        }
    }

    fn learn(&mut self, status: &Arc<Status>) {
        if status.source != self.status.source || status.state != State::Connected {
            self.awaited = 0;
            self.off = None;
        }
        if status.state != State::Connected && self.status.state == State::Connected {
            self.hand = [0.0; 2];
        }
        // Without a board it is said where the picture would be.
        if let Some(trouble) = &status.trouble
            && status.state == State::Connected
            && self.status.trouble.as_ref() != Some(trouble)
        {
            self.note(format!("warning: {trouble}"));
        }
        self.status = Arc::clone(status);
        self.condition_before = self.condition;
        self.condition.forget();
    }

    fn read(&mut self, item: &Item) {
        match item {
            Item::Sample(sample) => {
                self.condition.take(sample.status);
                if !self.is_paused {
                    self.strips.take(sample);
                    self.sample = Some(*sample);
                }
            }
            Item::Registers(_) => {}
            Item::Line(line) => {
                // The hub asks much that nobody here has asked.
                let is_answer = answer::is_one(line);
                if !is_answer || self.awaited > 0 {
                    self.note(line.clone());
                }
                if is_answer {
                    self.awaited = self.awaited.saturating_sub(1);
                }
            }
        }
    }

    /// Keeps a line.
    pub fn note(&mut self, line: String) {
        if self.lines.len() == LINES {
            self.lines.pop_front();
        }
        self.lines.push_back(line);
    }

    fn compare(&mut self, truth: &Truth) {
        let Some(sample) = &self.sample else {
            return;
        };
        if (truth.time - sample.arrival).abs() < TOGETHER {
            let [w, x, y, z] = truth.orientation;
            let truth = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
            self.off = Some(sample.orientation.angle_to(&truth));
        }
    }

    /// What the samples say of themselves.
    pub fn condition(&self) -> Condition {
        self.condition.with(&self.condition_before)
    }

    /// Body to world; upright before anything has come.
    pub fn orientation(&self) -> UnitQuaternion<f64> {
        self.sample
            .map_or_else(UnitQuaternion::identity, |sample| sample.orientation)
    }

    /// Who looks through the headset.
    pub fn viewer(&self) -> Viewer<f64> {
        let [neck, head] = NECK.map(Millimetres);
        let neck = HeadNeck::new(neck, head).ok().filter(|_| self.has_neck);
        Viewer {
            mounting: if self.is_turned_round {
                Mounting::TurnedAround
            } else {
                Mounting::Aligned
            },
            eyes: InterpupillaryDistance::of_the_notes(),
            neck: neck.unwrap_or_else(HeadNeck::none),
            position: Point3::new(0.0, EYES, 0.0),
        }
    }
}
