//! `vrduino calibrate`: the board lies still, lies on its faces, is turned; what is found it keeps.

mod guide;

mod keep;

mod map;

mod picture;

mod procedure;

mod progress;

mod report;

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use vrduino::calibration::record::Record;
use vrduino::sensor::magnetometer::SensitivityAdjustment;

use crate::arguments::{BoardArguments, within};
use crate::board::{self, Acquaintance};
use crate::failure::{Failure, Kind};
use crate::interrupt::Interrupt;
use crate::output::Output;
use guide::Guide;
use map::Map;
use procedure::Procedure;

/// The motion by which an emulated board is calibrated.
const MOTION: &str = "tumble";

/// An answer, or Ctrl-C, is not left waiting longer.
const NAP: Duration = Duration::from_millis(50);

/// What is said after Ctrl-C.
const STOPPED: &str = "stopped: the board is as it was";

const EXAMPLES: &str = "\
Examples:
  vrduino calibrate                                      the board that is plugged in; asks before it changes anything
  vrduino calibrate --emulate --part typical --yes       an emulated board with errors of its own, from end to end
  vrduino calibrate --dry-run board.keep                 the lines that hand the result to a board, into a file

A recording cannot be laid on its faces; a motion in a file is what `--emulate --motion FILE` takes.
What is refused is left as the board knows it. `:forget`, typed to the board, forgets everything.";

/// What is asked for.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Where from.
    #[command(flatten)]
    pub source: BoardArguments,
    /// Most seconds for each of the three parts
    #[arg(
        long,
        value_name = "S",
        default_value_t = 120.0,
        value_parser = within(1.0..=3600.0, "seconds"),
        allow_negative_numbers = true,
    )]
    pub seconds: f64,
    /// Hands the result to the board without asking
    #[arg(long, conflicts_with = "dry_run")]
    pub yes: bool,
    /// Writes the lines that hand the result to a board into this file, and sends nothing
    #[arg(long, value_name = "FILE")]
    pub dry_run: Option<PathBuf>,
    /// Where the picture goes: the directions from which the magnetic field has come
    #[arg(long, value_name = "FILE", default_value = "coverage.svg")]
    pub picture: PathBuf,
}

/// Guides through it, says what was found, and hands it to the board.
///
/// # Errors
///
/// There is no board, it sends no counts, or a part of the result is refused.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let board = board::meet(arguments.source.choice_moved_by(MOTION), "counts")?;
    let interrupt = Interrupt::listen();
    let mut output = Output::new();
    let mut procedure = Procedure::new(adjustment(&board)?);
    let guide = Guide::new(&board, &interrupt, arguments.seconds);
    if !guide.lead(&mut procedure, &mut output)? {
        output.say(STOPPED);
        return Ok(());
    }
    let refused = report::tell(&procedure, &mut output);
    if procedure.has_magnetometer()
        && let Err(failure) = draw(&procedure, arguments, &mut output)
    {
        // What was found is worth more than its picture.
        output.say(format!("\nno picture: {failure}"));
    }
    let record = procedure.record();
    if record != Record::default() {
        let went_on = settle(&board, &record, arguments, &interrupt, &mut output)?;
        if !went_on {
            output.say(format!("\n{STOPPED}"));
            return Ok(());
        }
    }
    match refused {
        None => Ok(()),
        Some(sentence) => Err(Failure::new(Kind::Stream, sentence)),
    }
}

/// By what the magnetometer's counts are adjusted.
fn adjustment(board: &Acquaintance) -> Result<Option<SensitivityAdjustment>, Failure> {
    let answer = board.hub.ask(":compass adjustment").map_err(|failure| {
        let sentence = format!(
            "{failure}; a program older than this one has to be flashed anew (`vrduino flash`)"
        );
        Failure::new(failure.kind, sentence)
    })?;
    let mut words = answer.split(' ').skip(2).map(str::parse);
    match (words.next(), words.next(), words.next()) {
        (Some(Ok(x)), Some(Ok(y)), Some(Ok(z))) => {
            Ok(Some(SensitivityAdjustment::from_fuse_rom([x, y, z])))
        }
        _ => Ok(None),
    }
}

fn draw(procedure: &Procedure, arguments: &Arguments, output: &mut Output) -> Result<(), Failure> {
    let path = &arguments.picture;
    let map = Map::so_far(procedure);
    let seen = 100.0 * (1.0 - map.missing().len() as f64 / Map::DIRECTIONS as f64);
    let title = format!("{seen:.0} % of all directions seen");
    fs::write(path, picture::svg(&map, &title)).map_err(|error| unwritten(path, &error))?;
    output.say(format!("\nthe directions are drawn in {}", path.display()));
    Ok(())
}

fn unwritten(path: &std::path::Path, error: &std::io::Error) -> Failure {
    let path = path.display();
    let sentence = format!("{path} cannot be written: {error}; name another file");
    Failure::new(Kind::File, sentence)
}

/// To the board, or into a file; whether Ctrl-C let it.
fn settle(
    board: &Acquaintance,
    record: &Record,
    arguments: &Arguments,
    interrupt: &Interrupt,
    output: &mut Output,
) -> Result<bool, Failure> {
    if let Some(path) = &arguments.dry_run {
        let lines: String = record.lines().map(|line| format!("{line}\n")).collect();
        if let Err(error) = fs::write(path, &lines) {
            output.say(format!("\nthe lines that hand this to a board:\n{lines}"));
            return Err(unwritten(path, &error));
        }
        output.say(format!(
            "nothing sent; {} has the lines that hand this to a board",
            path.display()
        ));
        return Ok(true);
    }
    let wanted = if arguments.yes {
        Some(true)
    } else if Output::is_terminal() {
        output.ask("\nLet the board keep what was found?", || {
            // The stream goes on, and nobody wants it now.
            board.updates.next(NAP);
            !interrupt.has_come()
        })?
    } else {
        Some(false)
    };
    match wanted {
        Some(true) => {}
        Some(false) => {
            output.say("nothing sent: the board is as it was (--yes lets it keep what was found)");
            return Ok(true);
        }
        None => return Ok(false),
    }
    let known = keep::hand_over(board, record)?;
    let known = known.strip_prefix("calibration: ").unwrap_or(&known);
    // The board tells of field and force only.
    let known = match known {
        "none" => "the gyro's bias; field and force are as the sensor was made",
        known => known,
    };
    output.say(format!("the board keeps it: {known}"));
    Ok(true)
}
