//! `vrduino monitor`: how the stream goes, a line a second.

use std::time::{Duration, Instant};

use clap::Args;

use crate::cli::SourceArguments;
use crate::failure::Failure;
use crate::hub::{Hold, Hub, Update};
use crate::interrupt::Interrupt;

/// What is asked for.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// Where from.
    #[command(flatten)]
    pub source: SourceArguments,
    /// Ends after so many seconds
    #[arg(long, value_name = "S")]
    pub seconds: Option<f64>,
}

/// Watches until the end, the time, or Ctrl-C.
///
/// # Errors
///
/// There is nothing to watch.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let interrupt = Interrupt::listen();
    let hub = Hub::start(arguments.source.choice(), Some("binary"));
    let updates = hub.subscribe(Hold::Newest(1000));
    let began = Instant::now();
    while !interrupt.has_come() {
        if arguments
            .seconds
            .is_some_and(|seconds| began.elapsed().as_secs_f64() > seconds)
        {
            break;
        }
        match updates.next(Duration::from_millis(100)) {
            Some(Update::Status(status)) => println!("{status:?}"),
            Some(Update::Ended(result)) => return result,
            Some(Update::Stream(items)) => {
                for i in items.iter() {
                    if let crate::stream::Item::Line(l) = i {
                        println!("{l}")
                    }
                }
            }
            _ => {}
        }
    }
    Ok(())
}
