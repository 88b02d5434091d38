//! What a port's errors mean, and what to do about them.

use std::io;

use serialport::ErrorKind;

use crate::failure::{Failure, Kind};

/// The rule by which Linux lets everybody who sits at the computer use the board.
pub const UDEV_RULE: &str = r#"ATTRS{idVendor}=="16c0", ATTRS{idProduct}=="04[789B]?", MODE:="0666", ENV{ID_MM_DEVICE_IGNORE}="1""#;

/// Why a port does not open.
pub fn opening(name: &str, error: &serialport::Error) -> Failure {
    let said = error.to_string();
    let busy = said.contains("exclusive lock")
        || said.contains("busy")
        || said.contains("Access is denied");
    let sentence = match error.kind() {
        _ if busy => format!(
            "{name} is in use by another program: close it (a serial monitor, or another vrduino), or, if that is `vrduino view`, open its page once more: it takes any number of viewers"
        ),
        ErrorKind::Io(io::ErrorKind::PermissionDenied) => format!(
            "{name} may not be opened by you: `vrduino doctor` prints the udev rule that allows it; until then `sudo chmod a+rw {name}` does for this once"
        ),
        ErrorKind::Io(io::ErrorKind::NotFound) | ErrorKind::NoDevice => {
            format!("{name} is not there: plug the board in, or see `vrduino list` for what is")
        }
        _ => format!(
            "{name} cannot be opened as a serial port: {said}; see `vrduino list` for those there are"
        ),
    };
    Failure::new(Kind::Board, sentence)
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
