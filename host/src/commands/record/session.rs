//! What is done while it records.

use std::mem;
use std::time::{Duration, Instant};

use jiff::Zoned;
use vrduino::command::request::Setting;

use super::progress::Progress;
use super::tally::Tally;
use crate::failure::{Failure, Kind};
use crate::hub::{Hub, State, Status, Subscription, Update};
use crate::interrupt::Interrupt;
use crate::patience::Patience;
use crate::recording::{Assembly, Entry, Head, Writer};
use crate::source;
use crate::stream::Item;

/// A board that has sent so many seconds of samples without saying who it is does not know the question.
const INTRODUCTION: f64 = 3.0;

/// Without any sample for so long the stream's own clock tells nothing about the time.
const SILENCE: Duration = Duration::from_secs(1);

/// Beyond the seconds that are asked for, for a board that starts, and for an image that has to be built first.
const FIRST_SAMPLE: Duration = Duration::from_secs(5);
const FIRST_OF_AN_IMAGE: Duration = Duration::from_secs(300);

/// Lines that are kept until the first sample comes.
const WAITING: usize = 10_000;

/// Records.
#[derive(Debug)]
pub struct Session<'a> {
    writer: &'a mut Writer,
    /// What the board is asked to stream.
    stream: &'static str,
    seconds: Option<f64>,
    assembly: Assembly,
    /// What has come and is not written yet: before the head is known, all of it.
    entries: Vec<Entry>,
    tally: Tally,
    progress: Progress,
    status: Status,
    began: Instant,
    /// When the first sample that is recorded came.
    first: Option<Instant>,
    /// Since the latest.
    silence: Patience,
}

impl<'a> Session<'a> {
    /// Until so many seconds are recorded, or without end.
    pub fn new(writer: &'a mut Writer, stream: &'static str, seconds: Option<f64>) -> Self {
        Self {
            writer,
            stream,
            seconds,
            assembly: Assembly::new(stream == "counts"),
            entries: Vec::new(),
            tally: Tally::default(),
            progress: Progress::new(seconds),
            status: Status::default(),
            began: Instant::now(),
            first: None,
            silence: Patience::new(),
        }
    }

    /// Until the end of the stream, of the time, or Ctrl-C.
    pub fn run(
        &mut self,
        hub: &Hub,
        updates: &Subscription,
        interrupt: &Interrupt,
    ) -> Result<(), Failure> {
        while !interrupt.has_come() {
            if let Some(update) = updates.next(Duration::from_millis(50))
                && let Some(end) = self.take(update)
            {
                return end;
            }
            if self.has_begun(hub)? {
                self.write()?;
            }
            self.writer.keep_up()?;
            let rate = self.status.report.rate;
            self.progress.show(&self.tally, rate, self.writer.bytes());
            if self.is_over()? {
                break;
            }
        }
        Ok(())
    }

    /// Takes what has come and waits; how the stream has ended, if it has.
    fn take(&mut self, update: Update) -> Option<Result<(), Failure>> {
        match update {
            Update::Stream(items) => {
                for item in items.iter() {
                    self.warn(item);
                    self.assembly.take(item, &mut self.entries);
                }
                self.forget_what_has_no_samples();
            }
            Update::Status(status) => self.look_at(&status),
            Update::Ended(result) => return Some(result),
            Update::Bytes(_) | Update::Truth(_) => {}
        }
        None
    }

    /// What came before the source was left, and waits because the file is slow.
    pub fn catch_up(&mut self, updates: &Subscription) {
        while let Some(update) = updates.next(Duration::ZERO) {
            if self.take(update).is_some() {
                break;
            }
        }
    }

    /// A device that sends lines and never a sample is no board: of them the newest are kept.
    fn forget_what_has_no_samples(&mut self) {
        if !self.writer.has_begun() && self.entries.len() > WAITING && !self.has_samples() {
            self.entries.drain(..WAITING / 2);
        }
    }

    /// Brings the file to its end, if it takes any more.
    pub fn end(&mut self) -> Result<Tally, Failure> {
        self.progress.end();
        if self.writer.has_failed() {
            return Ok(self.tally);
        }
        self.assembly.complete(&mut self.entries);
        if !self.writer.has_begun() {
            if !self.has_samples() {
                return Err(self.nothing());
            }
            self.begin()?;
        }
        self.write()?;
        self.writer.finish()?;
        Ok(self.tally)
    }

    /// Whether the head is written; it is once what is known of the board will not get more.
    fn has_begun(&mut self, hub: &Hub) -> Result<bool, Failure> {
        if !self.writer.has_begun() && self.is_time_to_begin(hub) {
            self.begin()?;
        }
        Ok(self.writer.has_begun())
    }

    fn is_time_to_begin(&mut self, hub: &Hub) -> bool {
        if self.status.kind == Some(source::Kind::Replay) {
            // It has been said before the first sample.
            self.status = (*hub.status()).clone();
            return self.has_samples();
        }
        let streams = self.status.stream.as_deref();
        let as_wanted = streams.is_some_and(|stream| stream.starts_with(self.stream));
        if as_wanted && self.status.settings.len() == Setting::ALL.len() {
            // It begins now: what came while the board was asked is of another kind.
            self.entries
                .retain(|entry| matches!(entry, Entry::Remark(_)));
            self.assembly.begin_anew();
            return true;
        }
        let arrivals = || {
            self.entries.iter().filter_map(|entry| match entry {
                Entry::Row(row) => Some(row.sample.arrival),
                Entry::Remark(_) => None,
            })
        };
        let span = arrivals().next_back().zip(arrivals().next());
        span.is_some_and(|(latest, first)| latest - first > INTRODUCTION)
    }

    fn has_samples(&self) -> bool {
        self.entries
            .iter()
            .any(|entry| matches!(entry, Entry::Row(_)))
    }

    fn begin(&mut self) -> Result<(), Failure> {
        let status = &self.status;
        let settings = status.settings.iter();
        self.writer.begin(&Head {
            started: Zoned::now().strftime("%Y-%m-%dT%H:%M:%S%:z").to_string(),
            source: status.source.clone(),
            board: status.version.clone(),
            estimator: status.estimator.clone(),
            stream: status.stream.clone(),
            settings: settings
                .map(|(&name, &value)| (name.to_owned(), value))
                .collect(),
            has_counts: self.stream == "counts",
        })
    }

    fn write(&mut self) -> Result<(), Failure> {
        for entry in mem::take(&mut self.entries) {
            if let Entry::Row(row) = &entry {
                if self.is_enough() {
                    continue;
                }
                self.tally.count(&row.sample);
                self.silence.renew();
                self.first.get_or_insert_with(Instant::now);
            }
            self.writer.write(&entry)?;
        }
        Ok(())
    }

    /// What changes is said here and noted in the file.
    fn look_at(&mut self, status: &Status) {
        let (before, now) = (self.status.state, status.state);
        if let Some(trouble) = &status.trouble
            && self.status.trouble.as_ref() != Some(trouble)
            // With nothing to note it in, it is the result.
            && !(now == State::Ended && self.first.is_none())
        {
            self.note(&trouble.sentence);
        } else if now == State::Connected && before == State::Lost {
            self.note(&format!("{} is there again", status.source));
        }
        self.status = status.clone();
    }

    /// What is missing in a recording that is played is missing in this one.
    fn warn(&mut self, item: &Item) {
        if let Item::Line(line) = item
            && self.status.kind == Some(source::Kind::Replay)
            && line.starts_with("warning: ")
        {
            self.progress.say(line);
        }
    }

    fn note(&mut self, sentence: &str) {
        self.progress.say(sentence);
        self.assembly.note(sentence, &mut self.entries);
    }

    fn is_enough(&self) -> bool {
        self.seconds
            .is_some_and(|seconds| self.tally.samples > 0 && self.tally.seconds() >= seconds)
    }

    /// By the stream's clock, and by the one on the wall where the stream has stopped.
    fn is_over(&mut self) -> Result<bool, Failure> {
        let Some(seconds) = self.seconds else {
            return Ok(false);
        };
        let limit = Duration::from_secs_f64(seconds);
        let Some(first) = self.first else {
            let grace = match self.status.kind {
                Some(source::Kind::Emulated) => FIRST_OF_AN_IMAGE,
                _ => FIRST_SAMPLE,
            };
            return match self.began.elapsed() > limit + grace {
                true => Err(self.nothing()),
                false => Ok(false),
            };
        };
        // The emulated board may take its time.
        let counts = self.status.kind != Some(source::Kind::Emulated);
        let is_late = counts && self.silence.look() > SILENCE && first.elapsed() > limit;
        Ok(self.is_enough() || is_late)
    }

    /// Why no sample has come.
    fn nothing(&self) -> Failure {
        match &self.status.trouble {
            Some(trouble) if self.status.state != State::Connected => trouble.clone(),
            None if self.status.state == State::Waiting => Failure::new(
                Kind::Board,
                "nothing is recorded: the board had not come. `vrduino list` shows what is plugged in",
            ),
            _ => Failure::new(
                Kind::Stream,
                "nothing is recorded: no orientation has come. Is it the right port (`vrduino list`), and is vrduino on the board (`vrduino doctor`)?",
            ),
        }
    }
}
