//! Single keys without a newline, as the course's programs send them. A colon begins a line that
//! a later version may understand; this one passes over it, so that the letters in it press no
//! keys.

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

/// Bytes after a colon before it is taken for line noise.
const LONGEST_LINE: u8 = 64;

/// Turns bytes from the host into commands, in whatever chunks they come.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parser {
    /// Bytes of a colon's line that may still follow; zero outside one.
    to_skip: u8,
}

impl Parser {
    /// Outside a line.
    pub const fn new() -> Self {
        Self { to_skip: 0 }
    }

    /// Takes one byte. Unknown ones mean nothing.
    pub fn push(&mut self, byte: u8) -> Option<Command> {
        if self.to_skip > 0 {
            self.to_skip = match byte {
                b'\n' | b'\r' => 0,
                _ => self.to_skip - 1,
            };
            return None;
        }
        match byte {
            b'0' => Some(Command::Mode(Mode::Info)),
            b'1' => Some(Command::Mode(Mode::Flat)),
            b'2' => Some(Command::Mode(Mode::ThreeD)),
            b'3' => Some(Command::Mode(Mode::Gyro)),
            b'4' => Some(Command::Mode(Mode::Accel)),
            b'5' => Some(Command::Mode(Mode::Quaternion)),
            b'r' => Some(Command::Reset),
            b'b' => Some(Command::MeasureBias),
            b':' => {
                self.to_skip = LONGEST_LINE;
                None
            }
            _ => None,
        }
    }
}
