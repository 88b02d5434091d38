//! `vrduino doctor`: looks for what is wrong, from the plug to the stream, and says what to do next.

mod check;

mod port;

mod program;

mod sensor;

mod stream;

mod tools;

mod watch;

use clap::Args;

use crate::arguments::BoardArguments;
use crate::board;
use crate::failure::Failure;
use crate::hub::{Hold, Hub};
use crate::output::Output;
use crate::source::Choice;
use check::Report;

/// An emulated board lies still, as a real one should while it is looked at.
const MOTION: &str = "still";

const MEANING: &str = "\
✓ is as it should be, ! may become a nuisance, ✗ has to be mended. Let the board lie still meanwhile: it takes some ten \
seconds. Without a board, --emulate shows what a healthy one looks like.";

/// What is asked for.
#[derive(Clone, Debug, Args)]
#[command(after_help = MEANING)]
pub struct Arguments {
    /// Where from.
    #[command(flatten)]
    pub source: BoardArguments,
}

/// Looks.
///
/// # Errors
///
/// Something is wrong.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut report = Report::new(Output::new());
    let choice = arguments.source.choice_moved_by(MOTION);
    if let Some(choice) = port::look(choice, &mut report) {
        listen(choice, &mut report);
    }
    tools::look(&mut report);
    report.end()
}

/// What comes from it, once it is there.
fn listen(choice: Choice, report: &mut Report) {
    let patience = board::patience(&choice);
    let emulated = matches!(choice, Choice::Emulated(_));
    let hub = Hub::start(choice, Some("counts"));
    let updates = hub.subscribe(Hold::All);
    match board::reach(&updates, patience) {
        Err(failure) => report.bad("it cannot be opened", failure.sentence),
        Ok(status) => {
            report.good(format!("{} opens", status.source));
            let seen = watch::watch(&hub, &updates);
            if program::look(&seen, report) {
                let calibrated = sensor::look(&hub, &seen, report);
                stream::look(&seen, calibrated, emulated, report);
            }
        }
    }
}
