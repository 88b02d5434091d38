//! What a port's errors mean, and what to do about them.

use std::io;

use serialport::ErrorKind;

use crate::failure::{Failure, Kind};

/// The rule by which Linux lets every user of the computer use the board, over the network too, as PJRC's
/// own does; the tag keeps it open to whoever sits there where somebody narrows the mode.
pub const UDEV_RULE: &str = r#"ATTRS{idVendor}=="16c0", ATTRS{idProduct}=="04[789B]?", MODE:="0666", TAG+="uaccess", ENV{ID_MM_DEVICE_IGNORE}="1""#;

/// What keeps a port from being opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Another program has it.
    InUse,
    /// The user may not open it.
    Denied,
    /// It is not there.
    Absent,
    /// Something else.
    Other,
}

impl Cause {
    fn of(error: &serialport::Error) -> Self {
        let said = error.to_string();
        match error.kind() {
            // The systems' own words: there is no kind for it.
            _ if ["exclusive lock", "busy", "Access is denied"]
                .iter()
                .any(|words| said.contains(words)) =>
            {
                Self::InUse
            }
            ErrorKind::Io(io::ErrorKind::PermissionDenied) => Self::Denied,
            ErrorKind::Io(io::ErrorKind::NotFound) | ErrorKind::NoDevice => Self::Absent,
            _ => Self::Other,
        }
    }
}

/// Why a port does not open.
pub fn opening(name: &str, error: &serialport::Error) -> (Cause, Failure) {
    let cause = Cause::of(error);
    let sentence = match cause {
        Cause::InUse => format!(
            "{name} is in use by another program: close it (a serial monitor, or another vrduino), or, if that is `vrduino view`, open its page once more: it takes any number of viewers"
        ),
        Cause::Denied => format!(
            "{name} may not be opened by you: `vrduino doctor` prints the udev rule that allows it; until then `sudo chmod a+rw {name}` does for this once"
        ),
        Cause::Absent => {
            format!("{name} is not there: plug the board in, or see `vrduino list` for what is")
        }
        Cause::Other => format!(
            "{name} cannot be opened as a serial port: {error}; see `vrduino list` for those there are"
        ),
    };
    (cause, Failure::new(Kind::Board, sentence))
}

/// Why a port that was open is not any more.
pub fn lost(name: &str, error: &io::Error) -> Failure {
    let sentence = match error.kind() {
        io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock => {
            format!("{name} takes nothing any more: plug the board in again")
        }
        _ => format!("{name} is gone: plug the board in again, it is looked for"),
    };
    Failure::new(Kind::Board, sentence)
}

#[cfg(test)]
mod tests {
    use super::{Cause, opening};
    use serialport::{Error, ErrorKind};
    use std::io;

    #[test]
    fn causes_are_told_apart_and_each_has_its_sentence() {
        for (kind, said, cause, words) in [
            (
                ErrorKind::NoDevice,
                "Unable to acquire exclusive lock on serial port",
                Cause::InUse,
                "in use",
            ),
            (
                ErrorKind::Io(io::ErrorKind::PermissionDenied),
                "Permission denied",
                Cause::Denied,
                "udev",
            ),
            (
                ErrorKind::NoDevice,
                "No such file or directory",
                Cause::Absent,
                "not there",
            ),
            (
                ErrorKind::Unknown,
                "Not a typewriter, in use or not",
                Cause::Other,
                "Not a typewriter",
            ),
        ] {
            let (found, failure) = opening("/dev/ttyACM0", &Error::new(kind, said));
            assert_eq!(found, cause, "{said}");
            assert!(failure.sentence.contains(words), "{failure}");
        }
    }
}
