//! Leads through the three parts.

use std::time::Duration;

use super::procedure::Procedure;
use super::progress::{Part, Progress};
use crate::board::Acquaintance;
use crate::failure::{Failure, Kind};
use crate::hub::{State, Update};
use crate::interrupt::Interrupt;
use crate::output::Output;
use crate::patience::Patience;
use crate::source;
use crate::stream::Item;

/// How long counts are waited for.
const SILENCE: Duration = Duration::from_secs(3);

/// The same of an emulated board, which may be slower than a real one.
const EMULATED_SILENCE: Duration = Duration::from_secs(60);

/// Leads through it.
pub struct Guide<'a> {
    board: &'a Acquaintance,
    interrupt: &'a Interrupt,
    seconds: f64,
}

impl<'a> Guide<'a> {
    /// With so many seconds at most for each part.
    pub fn new(board: &'a Acquaintance, interrupt: &'a Interrupt, seconds: f64) -> Self {
        Self {
            board,
            interrupt,
            seconds,
        }
    }

    /// Leads through all parts; whether it was let.
    ///
    /// # Errors
    ///
    /// The board goes, or sends no counts.
    pub fn lead(&self, procedure: &mut Procedure, output: &mut Output) -> Result<bool, Failure> {
        for part in Part::ALL {
            if part == Part::Turning && !procedure.has_magnetometer() {
                continue;
            }
            output.say(part.request());
            let mut progress = Progress::new(part);
            let went_on = self.follow(procedure, &mut progress, output);
            progress.clear();
            if !went_on? {
                return Ok(false);
            }
            output.say(format!("        {}", progress.state(procedure)));
        }
        Ok(true)
    }

    fn follow(
        &self,
        procedure: &mut Procedure,
        progress: &mut Progress,
        output: &mut Output,
    ) -> Result<bool, Failure> {
        let silence = match self.board.hub.status().kind {
            Some(source::Kind::Emulated) => EMULATED_SILENCE,
            _ => SILENCE,
        };
        let mut unheard = Patience::new();
        loop {
            if self.interrupt.has_come() || output.is_closed() {
                return Ok(false);
            }
            match self.board.updates.next(Duration::from_millis(100)) {
                Some(Update::Stream(items)) => {
                    for item in items.iter() {
                        match item {
                            Item::Sample(sample) => progress.pass(sample.time, sample.is_first),
                            Item::Registers(registers) => {
                                unheard.renew();
                                progress.take(&registers.counts, procedure, output);
                            }
                            Item::Line(line) if line.starts_with("error") => {
                                return Err(Failure::new(
                                    Kind::Stream,
                                    format!(
                                        "the board says `{line}`; `vrduino doctor` looks closer"
                                    ),
                                ));
                            }
                            Item::Line(_) => {}
                        }
                        if progress.is_over(procedure, self.seconds) {
                            return Ok(true);
                        }
                    }
                }
                Some(Update::Status(status)) => {
                    if let (Some(failure), State::Lost | State::Ended) =
                        (&status.trouble, status.state)
                    {
                        let sentence = format!("{failure}; nothing was kept, run this again");
                        return Err(Failure::new(failure.kind, sentence));
                    }
                }
                Some(Update::Bytes(_) | Update::Truth(_)) => {}
                Some(Update::Ended(Err(failure))) => return Err(failure),
                Some(Update::Ended(Ok(()))) | None => {}
            }
            if unheard.look() > silence {
                return Err(Failure::new(
                    Kind::Stream,
                    "the board sends no counts: its sensor may have stopped (`vrduino doctor` looks closer)",
                ));
            }
        }
    }
}
