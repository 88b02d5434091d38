//! Single keys without a newline, as the course's programs send them, and lines that begin with a
//! colon, requests ([`request`](crate::command::request)), whose letters press no keys.
//!
//! A line that begins with anything else is passed over to its end: a terminal that nobody has told
//! otherwise echoes what the board streams, and the digits in it would press keys without end. No line
//! of the stream begins with a key or a colon. Frames hold any byte; what begins with a zero, or with the `^@`
//! that a terminal makes of it, is passed over until nothing has come for a while.

mod number;
pub mod request;
mod setting;

use heapless::String;
use request::{Refusal, Request};

/// What the lines show. The digits are the course's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// `0`: once a second, what the board knows about itself.
    Info,
    /// `1`: the flatland filter.
    Flat,
    /// `2`: gyro, accelerometer and fused orientation side by side.
    ThreeD,
    /// `3`: readings of the gyro.
    Gyro,
    /// `4`: readings of the accelerometer.
    Accel,
    /// `5`: the fused orientation.
    #[default]
    Quaternion,
}

/// What the host asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// `0` to `5`: show this.
    Mode(Mode),
    /// `r`: straight ahead is where the board points now.
    Reset,
    /// `b`: measure the gyro's bias again.
    MeasureBias,
    /// A line that began with a colon: what it asks for, or why it was not understood.
    Line(Result<Request, Refusal>),
}

/// Bytes after which a line is taken for noise: more than the longest line of the stream.
const LONGEST_LINE: u8 = 128;
/// Longest request, without its colon.
const LONGEST_REQUEST: usize = 72;
/// Calls of [`Parser::idle`] in a row after which a mistyped key is forgotten. An echo never pauses
/// as long inside a line.
const SILENCE: u16 = 20;
/// The same for a request that nobody ends: ten seconds are enough to type one.
const LONG_SILENCE: u16 = 10_000;

/// What the bytes belong to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Place {
    /// Each is a key.
    #[default]
    Outside,
    /// A colon's line.
    Request,
    /// A line that is none of ours, or has been refused; so many bytes may still follow.
    Foreign(u8),
    /// Frames: all of it, newlines included.
    Frames,
}

/// Turns bytes from the host into commands, in whatever chunks they come.
#[derive(Clone, Debug, Default)]
pub struct Parser {
    place: Place,
    request: String<LONGEST_REQUEST>,
    silence: u16,
}

impl Parser {
    /// Outside a line.
    pub const fn new() -> Self {
        Self {
            place: Place::Outside,
            request: String::new(),
            silence: 0,
        }
    }

    /// Nothing came for a millisecond.
    pub fn idle(&mut self) {
        self.silence = self.silence.saturating_add(1);
        let patience = match self.place {
            Place::Outside => return,
            Place::Foreign(_) | Place::Frames => SILENCE,
            Place::Request => LONG_SILENCE,
        };
        if self.silence >= patience {
            self.place = Place::Outside;
            self.request.clear();
        }
    }

    /// Takes one byte.
    pub fn push(&mut self, byte: u8) -> Option<Command> {
        self.silence = 0;
        let end_of_line = matches!(byte, b'\n' | b'\r');
        match self.place {
            _ if byte == 0 => {
                self.place = Place::Frames;
                self.request.clear();
            }
            Place::Frames => {}
            Place::Outside => return self.key(byte),
            Place::Request if end_of_line => {
                self.place = Place::Outside;
                let request = request::parse(&self.request);
                self.request.clear();
                return Some(Command::Line(request));
            }
            Place::Request => return self.letter(byte),
            Place::Foreign(0) => self.place = Place::Outside,
            Place::Foreign(_) if end_of_line => self.place = Place::Outside,
            Place::Foreign(left) => self.place = Place::Foreign(left - 1),
        }
        None
    }

    /// One more of a request. What is no ASCII becomes a question mark, and so no verb.
    fn letter(&mut self, byte: u8) -> Option<Command> {
        let letter = if byte.is_ascii() {
            char::from(byte)
        } else {
            '?'
        };
        if self.request.push(letter).is_ok() {
            return None;
        }
        self.place = Place::Foreign(LONGEST_LINE);
        let refusal = Refusal::too_long(&self.request);
        self.request.clear();
        Some(Command::Line(Err(refusal)))
    }

    fn key(&mut self, byte: u8) -> Option<Command> {
        let command = match byte {
            b'0' => Command::Mode(Mode::Info),
            b'1' => Command::Mode(Mode::Flat),
            b'2' => Command::Mode(Mode::ThreeD),
            b'3' => Command::Mode(Mode::Gyro),
            b'4' => Command::Mode(Mode::Accel),
            b'5' => Command::Mode(Mode::Quaternion),
            b'r' => Command::Reset,
            b'b' => Command::MeasureBias,
            b':' => {
                self.place = Place::Request;
                return None;
            }
            b'\n' | b'\r' | b' ' => return None,
            b'^' => {
                self.place = Place::Frames;
                return None;
            }
            _ => {
                self.place = Place::Foreign(LONGEST_LINE);
                return None;
            }
        };
        Some(command)
    }
}
