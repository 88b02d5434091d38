//! `vrduino monitor`: how the stream goes.

mod output;

mod tally;

mod verdict;

use std::time::{Duration, Instant};

use clap::Args;

use crate::arguments::{SourceArguments, within};
use crate::failure::Failure;
use crate::hub::{Hold, Hub, State, Status, Subscription, Update};
use crate::interrupt::Interrupt;
use crate::source::{Choice, Kind};
use output::{Closed, Output};
use tally::Tally;

/// What is asked for.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
The delay of a sample is by how much later it came than the fastest of the last twenty seconds did: the device's clock says \
when it was measured, this computer's when it was read, and neither knows what the other's zero is. So what even the fastest \
need is not in it; what stutters and piles up is. A stream without device time (`QC` alone) has no delay and no numbers by \
which losses could be seen: the board is therefore asked for frames, and for what it sent before at the end.

Missing are samples whose number never came, CRC errors lines and frames that were changed on the way, malformed those that \
are none, thrown away the bytes of both.

Examples:
  vrduino monitor                           the board that is plugged in, until Ctrl-C
  vrduino monitor --emulate --seconds 10    the emulated one, for ten seconds
  vrduino monitor --json --interval 5       a line of JSON every five seconds, for programs")]
pub struct Arguments {
    /// Where from.
    #[command(flatten)]
    pub source: SourceArguments,
    /// Ends after so many seconds; what the emulated board takes to be built is not counted
    #[arg(long, value_name = "S", value_parser = within(0.0..=1e9, "seconds"), allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// Seconds between two lines, from 0.1 on
    #[arg(
        long,
        value_name = "S",
        default_value = "1",
        value_parser = within(0.1..=86_400.0, "seconds"),
        allow_negative_numbers = true,
    )]
    pub interval: f64,
    /// Prints a JSON object a line, for programs
    #[arg(long)]
    pub json: bool,
}

/// Watches until the end, the time, or Ctrl-C.
///
/// # Errors
///
/// There was no board, or it sent no orientation.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let interrupt = Interrupt::listen();
    let choice = arguments.source.choice();
    let mut watch = Watch::new(arguments, &choice);
    let (hub, updates) = Hub::open(choice, Some("binary"), Hold::Newest(4096));
    match watch.until_the_end(&hub, &updates, &interrupt) {
        Ok(ended) => {
            let status = hub.status_now();
            drop(hub);
            watch.conclude(&status, ended)
        }
        // Nobody reads on: that is all they wanted.
        Err(Closed) => Ok(()),
    }
}

/// What is seen, and what of it has been said.
struct Watch {
    output: Output,
    tally: Tally,
    interval: Duration,
    seconds: Option<Duration>,
    /// Whether the time is counted before it is there.
    counts_waiting: bool,
    began: Instant,
    /// Whether the source has said how it is, and whether it has been there.
    has_spoken: bool,
    seen: bool,
    told: Instant,
    state: State,
    trouble: Option<Failure>,
}

impl Watch {
    fn new(arguments: &Arguments, choice: &Choice) -> Self {
        Self {
            output: Output::new(arguments.json),
            tally: Tally::default(),
            interval: Duration::from_secs_f64(arguments.interval),
            seconds: arguments.seconds.map(Duration::from_secs_f64),
            counts_waiting: choice.kind() != Kind::Emulated,
            began: Instant::now(),
            has_spoken: false,
            seen: false,
            told: Instant::now(),
            state: State::Waiting,
            trouble: None,
        }
    }

    /// Watches; why the source has ended, if it has.
    fn until_the_end(
        &mut self,
        hub: &Hub,
        updates: &Subscription,
        interrupt: &Interrupt,
    ) -> Result<Option<Result<(), Failure>>, Closed> {
        while !interrupt.has_come() && !self.is_over() {
            match updates.next(Duration::from_millis(20)) {
                Some(Update::Stream(items)) => {
                    for item in items.iter() {
                        if let Some(line) = self.tally.take(item) {
                            self.output.line(line)?;
                        }
                    }
                }
                Some(Update::Status(status)) => self.notice(&status)?,
                Some(Update::Ended(result)) => return Ok(Some(result)),
                Some(Update::Bytes(_) | Update::Truth(_)) | None => {}
            }
            if self.state == State::Connected && self.told.elapsed() >= self.interval {
                self.told = Instant::now();
                self.output.stream(&hub.status_now(), &mut self.tally)?;
            }
        }
        Ok(None)
    }

    fn is_over(&self) -> bool {
        let runs = self.seen || self.counts_waiting && self.has_spoken;
        runs && self
            .seconds
            .is_some_and(|seconds| self.began.elapsed() >= seconds)
    }

    /// Says what has changed.
    fn notice(&mut self, status: &Status) -> Result<(), Closed> {
        self.has_spoken |= status.trouble.is_some() || status.state != State::Waiting;
        if status.trouble != self.trouble {
            self.trouble.clone_from(&status.trouble);
            // What ends it is said at the end.
            if let Some(trouble) = &self.trouble
                && status.state != State::Ended
            {
                self.output.trouble(status.state, &trouble.sentence)?;
            }
        }
        if status.state != self.state {
            self.state = status.state;
            if self.state == State::Connected {
                self.output.connected(&status.source)?;
                self.told = Instant::now();
                if !self.seen && !self.counts_waiting {
                    self.began = Instant::now();
                }
                self.seen = true;
            }
        }
        Ok(())
    }

    /// The summary, or why there is none.
    fn conclude(self, status: &Status, ended: Option<Result<(), Failure>>) -> Result<(), Failure> {
        if self.tally.samples() == 0 {
            self.output.clear();
            return Err(match ended {
                Some(Err(failure)) => failure,
                _ if !self.seen => verdict::no_board(status),
                _ => verdict::no_samples(status, &self.tally),
            });
        }
        let seconds = self.began.elapsed().as_secs_f64();
        // Nobody may read on; there is nobody to be told.
        let _ = self.output.summary(status, &self.tally, seconds);
        ended.unwrap_or(Ok(()))
    }
}
