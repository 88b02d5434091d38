//! Single keys without a newline, as the course's programs send them. A colon begins a line that
//! a later version may understand; this one passes over it, so that the letters in it press no
//! keys.
//!
//! So it does with a line that begins with anything else: a terminal that nobody has told otherwise
//! echoes what the board streams, and the digits in it would press keys without end. No line of the
//! stream begins with a key.

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

/// What a key asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// `0` to `5`: show this.
    Mode(Mode),
    /// `r`: straight ahead is where the board points now.
    Reset,
    /// `b`: measure the gyro's bias again.
    MeasureBias,
}

/// Bytes after which a line is taken for noise: more than the longest line of the stream.
const LONGEST_LINE: u8 = 128;
/// Calls of [`Parser::idle`] in a row after which a mistyped key is forgotten. An echo never pauses
/// as long inside a line.
const SILENCE: u8 = 20;

/// What the bytes belong to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Place {
    /// Each is a key.
    #[default]
    Outside,
    /// A colon's line; so many may still follow.
    Command(u8),
    /// A line that is none of ours.
    Foreign(u8),
}

/// Turns bytes from the host into commands, in whatever chunks they come.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parser {
    place: Place,
    silence: u8,
}

impl Parser {
    /// Outside a line.
    pub const fn new() -> Self {
        Self {
            place: Place::Outside,
            silence: 0,
        }
    }

    /// Nothing came for a millisecond.
    pub fn idle(&mut self) {
        self.silence = self.silence.saturating_add(1);
        if self.silence >= SILENCE && matches!(self.place, Place::Foreign(_)) {
            self.place = Place::Outside;
        }
    }

    /// Takes one byte.
    pub fn push(&mut self, byte: u8) -> Option<Command> {
        self.silence = 0;
        let end_of_line = matches!(byte, b'\n' | b'\r');
        self.place = match self.place {
            Place::Outside => return self.key(byte),
            Place::Command(0) | Place::Foreign(0) => Place::Outside,
            _ if end_of_line => Place::Outside,
            Place::Command(left) => Place::Command(left - 1),
            Place::Foreign(left) => Place::Foreign(left - 1),
        };
        None
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
                self.place = Place::Command(LONGEST_LINE);
                return None;
            }
            b'\n' | b'\r' | b' ' => return None,
            _ => {
                self.place = Place::Foreign(LONGEST_LINE);
                return None;
            }
        };
        Some(command)
    }
}
