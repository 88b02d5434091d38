//! A record handed to the board, which checks it and keeps it.

use std::time::{Duration, Instant};

use vrduino::calibration::record::Record;

use crate::board::Acquaintance;
use crate::failure::{Failure, Kind};
use crate::hub::Update;
use crate::stream::Item;

/// How long the board may take to write it: a tenth of a second, and twenty for a chip that never had any.
const WRITING: Duration = Duration::from_secs(5);

/// Hands it over: what the board then knows.
///
/// # Errors
///
/// The board refuses it, cannot keep it, or does not answer.
pub fn hand_over(board: &Acquaintance, record: &Record) -> Result<String, Failure> {
    // What has come before is not its answer.
    while board.updates.next(Duration::ZERO).is_some() {}
    let mut known = String::new();
    for line in record.lines() {
        known = board.hub.ask(&line)?;
    }
    match verdict(board) {
        Some(Ok(())) => Ok(known),
        Some(Err(line)) => Err(Failure::new(
            Kind::Stream,
            format!(
                "the board uses the calibration until it is unplugged, but says `{line}`: see \"kept\" in docs/commands.md, and run this again"
            ),
        )),
        None => Err(Failure::new(
            Kind::Stream,
            "the board uses the calibration, but has not said that it is kept: ask `:calibration` after it was unplugged",
        )),
    }
}

fn verdict(board: &Acquaintance) -> Option<Result<(), String>> {
    let until = Instant::now() + WRITING;
    loop {
        let left = until.saturating_duration_since(Instant::now());
        let Update::Stream(items) = board.updates.next(left)? else {
            continue;
        };
        for item in items.iter() {
            match item {
                Item::Line(line) if line == "calibration kept" => return Some(Ok(())),
                Item::Line(line) if line.starts_with("error: calibration not kept") => {
                    return Some(Err(line.clone()));
                }
                Item::Line(_) | Item::Sample(_) | Item::Registers(_) => {}
            }
        }
    }
}
