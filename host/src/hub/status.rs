//! How things are with the source and the board behind it.

use std::collections::BTreeMap;

use vrduino::command::request::Setting;

use crate::failure::{self, Failure};
use crate::source::{Choice, Kind, emulated};
use crate::stream::Report;

/// Whether the source is there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// It has not been there yet.
    #[default]
    Waiting,
    /// It is.
    Connected,
    /// It was, and is looked for.
    Lost,
    /// It will not come back.
    Ended,
}

/// How things are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Status {
    /// Name of the source.
    pub source: String,
    /// What it is.
    pub kind: Option<Kind>,
    /// Whether it is there.
    pub state: State,
    /// Why it is not, or what is wrong although it is, and what to do.
    pub trouble: Option<Failure>,
    /// How the stream goes.
    pub report: Report,
    /// What the board says it is, as `vrduino 0.1.0`.
    pub version: Option<String>,
    /// The estimator that makes the orientation.
    pub estimator: Option<String>,
    /// What is streamed, as `binary every 1`.
    pub stream: Option<String>,
    /// The board's settings, as far as it has told them.
    pub settings: BTreeMap<&'static str, f64>,
    /// What the emulated sensor can be carried through; empty for anything else.
    pub motions: &'static [&'static str],
    /// And what it is carried through.
    pub motion: Option<String>,
}

impl Status {
    /// Before anything has happened.
    pub(super) fn of(choice: &Choice) -> Self {
        let (source, motions, motion) = match choice {
            Choice::Port(name) => (name.clone().unwrap_or_default(), [].as_slice(), None),
            Choice::Emulated(emulation) => (
                emulated::NAME.into(),
                emulated::MOTIONS.as_slice(),
                Some(emulation.motion.clone()),
            ),
            Choice::Replay(replay) => (replay.path.display().to_string(), [].as_slice(), None),
        };
        Self {
            source,
            kind: Some(choice.kind()),
            motions,
            motion,
            ..Self::default()
        }
    }

    /// How things are, for a person.
    pub fn sentence(&self) -> String {
        if let Some(failure) = &self.trouble {
            return failure.sentence.clone();
        }
        match (self.state, self.kind) {
            (State::Connected, Some(Kind::Replay)) => format!("{} is played", self.source),
            (State::Connected, Some(Kind::Emulated)) => "the emulated board is connected".into(),
            (State::Connected, _) => format!("{} is connected", self.source),
            (State::Ended, _) => "the recording is at its end".into(),
            (_, Some(Kind::Emulated)) => "the emulated board starts".into(),
            (_, Some(Kind::Replay)) => "the recording is opened".into(),
            _ => "the board is looked for".into(),
        }
    }

    pub(super) fn connected(&mut self, name: String) {
        self.source = name;
        self.state = State::Connected;
        self.trouble = None;
    }

    pub(super) fn absent(&mut self, state: State, failure: Failure) {
        // One that was there once is lost until it is there again.
        let lost = self.state == State::Lost && state == State::Waiting;
        self.state = if lost { State::Lost } else { state };
        self.trouble = Some(failure);
        self.version = None;
        self.estimator = None;
        self.stream = None;
        self.settings.clear();
    }

    /// The board does not answer; whether that is news.
    pub(super) fn estrange(&mut self) -> bool {
        let news = self.trouble.is_none();
        let sentence = "nothing answers as vrduino does: another program runs on the board, or this is not its port (`vrduino list`); it is sent keys but no settings";
        self.trouble
            .get_or_insert_with(|| Failure::new(failure::Kind::Stream, sentence));
        news
    }

    pub(super) fn ended(&mut self, result: &Result<(), Failure>) {
        self.state = State::Ended;
        self.trouble = result.clone().err();
    }

    /// Takes what a line of the board's tells; whether it did.
    pub(super) fn learn(&mut self, line: &str) -> bool {
        let Some(answer) = line.strip_prefix("OK ") else {
            return false;
        };
        let mut words = answer.split(' ');
        match (words.next(), words.next()) {
            (Some("vrduino"), Some(_)) => {
                self.version = Some(answer.to_owned());
                self.trouble = None;
            }
            (Some("estimator"), Some(name)) => self.estimator = Some(name.to_owned()),
            (Some("stream"), Some(_)) => self.stream = Some(answer["stream ".len()..].to_owned()),
            (Some(name), Some(value)) => {
                let setting = Setting::ALL
                    .into_iter()
                    .find(|setting| setting.name() == name);
                let (Some(setting), Ok(value)) = (setting, value.parse()) else {
                    return false;
                };
                self.settings.insert(setting.name(), value);
            }
            _ => return false,
        }
        true
    }
}
