//! What comes to the board from outside, in a form that can be written down.

use std::fmt;
use std::str::FromStr;

use clap::ValueEnum;
use vrduino_emulator::board::Board;

/// What can be broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    Absent,
    Frozen,
    MagnetometerAbsent,
    MagnetometerFrozen,
    BrownOut,
    StuckSda,
    StuckScl,
    NoPullUps,
    Unread,
    Unplugged,
    NoisyUsb,
}

/// Something from outside.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Input {
    /// Bytes for the serial port.
    Typed(Vec<u8>),
    /// Something breaks, or is mended.
    Fault(Kind, bool),
    /// Whether whoever reads the stream keeps up.
    Reading(bool),
}

impl Input {
    /// Does it to the board.
    pub fn apply(&self, board: &mut Board) {
        let now = board.now();
        let mut chip = board.chip();
        match *self {
            Input::Typed(ref keys) => chip.host.send(keys),
            Input::Reading(reading) => chip.host.set_reading(reading),
            Input::Fault(kind, on) => match kind {
                Kind::Absent => chip.sensor.faults.absent = on,
                Kind::Frozen => chip.sensor.faults.frozen = on,
                Kind::MagnetometerAbsent | Kind::MagnetometerFrozen => {
                    if let Some(magnetometer) = chip.sensor.magnetometer() {
                        match kind {
                            Kind::MagnetometerAbsent => magnetometer.faults.absent = on,
                            _ => magnetometer.faults.frozen = on,
                        }
                    }
                }
                Kind::BrownOut if on => chip.sensor.brown_out(now),
                Kind::BrownOut => {}
                Kind::StuckSda => chip.pins.sda_held_for = if on { 5 } else { 0 },
                Kind::StuckScl => chip.pins.scl_held = on,
                Kind::NoPullUps => chip.pins.no_pull_ups = on,
                Kind::NoisyUsb => chip.host.set_noise(if on { 5 } else { 0 }),
                Kind::Unread => chip.host.set_reading(!on),
                Kind::Unplugged => chip.host.set_plugged(!on),
            },
        }
    }
}

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let switch = |on| if on { "on" } else { "off" };
        match self {
            Input::Typed(keys) => write!(f, "typed {}", keys.escape_ascii()),
            Input::Reading(reading) => write!(f, "reading {}", switch(*reading)),
            Input::Fault(kind, on) => {
                let value = kind.to_possible_value();
                let name = value.as_ref().map_or("", |value| value.get_name());
                write!(f, "fault {name} {}", switch(*on))
            }
        }
    }
}

impl FromStr for Input {
    type Err = String;

    fn from_str(text: &str) -> Result<Input, String> {
        let switch = |word: &str| match word {
            "on" => Ok(true),
            "off" => Ok(false),
            _ => Err(format!("{word:?} is neither on nor off")),
        };
        match text.split_once(' ') {
            Some(("typed", keys)) => unescape(keys)
                .map(Input::Typed)
                .ok_or_else(|| format!("{keys:?} has a broken escape sequence")),
            Some(("reading", word)) => switch(word).map(Input::Reading),
            Some(("fault", rest)) => {
                let (kind, word) = rest.split_once(' ').unwrap_or((rest, ""));
                let kind = Kind::from_str(kind, true)
                    .map_err(|_| format!("there is no fault {kind:?}"))?;
                Ok(Input::Fault(kind, switch(word)?))
            }
            _ => Err(format!("{text:?} is no input")),
        }
    }
}

/// The bytes that [`slice::escape_ascii`] has made readable.
fn unescape(text: &str) -> Option<Vec<u8>> {
    let mut bytes = text.bytes();
    let mut plain = Vec::new();
    while let Some(byte) = bytes.next() {
        if byte != b'\\' {
            plain.push(byte);
            continue;
        }
        plain.push(match bytes.next()? {
            b't' => b'\t',
            b'r' => b'\r',
            b'n' => b'\n',
            b'x' => {
                let digits = [bytes.next()?, bytes.next()?];
                u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?
            }
            other @ (b'\\' | b'\'' | b'"') => other,
            _ => return None,
        });
    }
    Some(plain)
}

#[cfg(test)]
mod tests {
    use super::{Input, Kind};

    #[test]
    fn inputs_are_read_back_as_they_were_written() {
        let inputs = [
            Input::Typed((0..=255).collect()),
            Input::Typed(b" 2\r\n".to_vec()),
            Input::Reading(false),
            Input::Fault(Kind::StuckSda, true),
            Input::Fault(Kind::BrownOut, false),
        ];
        for input in inputs {
            assert_eq!(input.to_string().parse(), Ok(input));
        }
        for wrong in [
            "",
            "typed \\",
            "typed \\x4",
            "fault x on",
            "reading maybe",
            "fault absent",
        ] {
            assert!(wrong.parse::<Input>().is_err(), "{wrong:?}");
        }
    }
}
