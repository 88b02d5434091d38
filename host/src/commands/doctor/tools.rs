//! What it takes to flash.

use vrduino_emulator::firmware;

use crate::commands::flash::{LOADER, WHERE_TO_GET_IT};
use crate::computer::{programs, udev};

use super::check::Report;
use super::port::install_rule;

/// Looks for it. Without it everything but flashing works.
pub fn look(report: &mut Report) {
    match programs::installed(LOADER) {
        Some(path) => report.good(format!("{LOADER} is installed: {}", path.display())),
        None => report.doubt(
            format!("{LOADER} is not installed: flashing needs it"),
            WHERE_TO_GET_IT,
        ),
    }
    if udev::is_used() {
        match udev::rule() {
            Some(path) => report.good(format!("{} opens Teensys to you", path.display())),
            None => report.doubt(
                "there is no udev rule for Teensys: in its loader a board may be opened by the superuser only",
                format!("to flash without sudo:\n{}", install_rule()),
            ),
        }
    }
    let built = firmware::target_dir().map(|folder| {
        folder
            .join(firmware::TARGET)
            .join(firmware::PROFILE)
            .join("firmware")
    });
    match built {
        Ok(path) if path.is_file() => {
            report.good(format!("the board's image is built: {}", path.display()))
        }
        Ok(_) => report
            .note("the board's image is not built yet: `vrduino flash` and --emulate build it"),
        Err(error) => report.doubt("the board's image cannot be built", error.to_string()),
    }
}
