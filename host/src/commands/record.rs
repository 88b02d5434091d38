//! `vrduino record`: the stream into a file, with nothing lost.

mod progress;

mod session;

mod tally;

mod target;

use std::path::PathBuf;

use clap::Args;

use crate::arguments::{SourceArguments, within};
use crate::failure::Failure;
use crate::hub::{Hold, Hub};
use crate::interrupt::Interrupt;
use crate::recording::Writer;
use session::Session;
pub use target::Format;
use target::Target;

const EXAMPLES: &str = "\
Examples:
  vrduino record                               until Ctrl-C; the file is named by the time
  vrduino record --seconds 60 desk.csv         a minute
  vrduino record --counts --emulate head.csv   the emulated board, with its sensor's registers
  vrduino plot desk.csv                        a picture of it
  vrduino view --replay desk.csv               see it again

What is recorded is in the file within a second, once the board has said who it is. docs/recordings.md tells what stands in the file.";

/// What is asked for.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Into this file: *.csv, or *.parquet; without one, vrduino-YYYY-MM-DD-HHMMSS.csv
    pub file: Option<PathBuf>,
    /// Where from.
    #[command(flatten)]
    pub source: SourceArguments,
    /// Ends after so many seconds of the stream
    #[arg(long, value_name = "S", value_parser = within(1e-3..=1e9, "seconds"), allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// With what the sensor's registers held, the magnetometer's included
    #[arg(long)]
    pub counts: bool,
    /// How the file is written; otherwise by the ending of its name
    #[arg(long, value_name = "FORMAT")]
    pub format: Option<Format>,
    /// Writes over a file that is there already
    #[arg(long)]
    pub force: bool,
}

/// Records until the end, the time, or Ctrl-C.
///
/// # Errors
///
/// There is nothing to record, or the file cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let target = Target::of(arguments.file.as_deref(), arguments.format, arguments.force)?;
    if let Some(replayed) = &arguments.source.replay {
        target.is_not(replayed)?;
    }
    let interrupt = Interrupt::listen();
    let mut writer = Writer::create(target.written(), arguments.force)?;
    let stream = if arguments.counts { "counts" } else { "binary" };
    let (hub, updates) = Hub::open(arguments.source.choice(), Some(stream), Hold::All);
    let mut session = Session::new(&mut writer, stream, arguments.seconds);
    let outcome = session.run(&hub, &updates, &interrupt);
    // The board streams as before while the rest is done.
    drop(hub);
    session.catch_up(&updates);
    let tally = session.end();
    if !writer.has_begun() {
        writer.abandon();
        return outcome.and(tally.map(drop));
    }
    if writer.has_failed() {
        return outcome.and(tally.map(drop));
    }
    let told = tally.and_then(|tally| {
        let bytes = target.convert(writer.bytes())?;
        target.tell(&tally, bytes);
        Ok(())
    });
    outcome.and(told)
}
