//! A recording at the pace at which it came.

use std::path::Path;
use std::time::Duration;

use super::{Entry, Head, Reader};
use crate::failure::Failure;

/// What came at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// How long after the beginning it is due.
    pub due: Duration,
    /// When it came, in s on the source's clock.
    pub at: f64,
    /// Times in it have nothing to do with those before.
    pub is_first: bool,
    /// What came.
    pub entries: Vec<Entry>,
}

/// Tells what is due when.
#[derive(Debug)]
pub struct Player {
    reader: Reader,
    speed: f64,
    /// Read ahead.
    next: Option<Entry>,
    /// The moment of the recording that is due, and how far that is from the first.
    at: Option<f64>,
    elapsed: f64,
}

impl Player {
    /// Opens a recording, to be played `speed` times as fast as it came.
    ///
    /// # Errors
    ///
    /// As for [`Reader::open`].
    pub fn open(path: &Path, speed: f64) -> Result<Self, Failure> {
        Ok(Self {
            reader: Reader::open(path)?,
            speed,
            next: None,
            at: None,
            elapsed: 0.0,
        })
    }

    /// What is known of the recording as a whole.
    pub fn head(&self) -> &Head {
        self.reader.head()
    }

    /// The next; none behind the last.
    ///
    /// # Errors
    ///
    /// As for [`Reader::read`].
    pub fn next_batch(&mut self) -> Result<Option<Batch>, Failure> {
        let mut batch: Option<Batch> = None;
        loop {
            let entry = match self.next.take() {
                Some(entry) => entry,
                None => match self.reader.read()? {
                    Some(entry) => entry,
                    None => return Ok(batch),
                },
            };
            let (arrival, is_first) = match &entry {
                Entry::Row(row) => (Some(row.sample.arrival), row.sample.is_first),
                // A remark stands behind what it follows.
                Entry::Remark(_) => (None, false),
            };
            let goes_on =
                |batch: &Batch| !is_first && arrival.is_none_or(|arrival| arrival == batch.at);
            if batch.as_ref().is_some_and(|batch| !goes_on(batch)) {
                self.next = Some(entry);
                return Ok(batch);
            }
            match &mut batch {
                Some(batch) => batch.entries.push(entry),
                None => batch = Some(self.begin(arrival, is_first, entry)),
            }
        }
    }

    fn begin(&mut self, arrival: Option<f64>, is_first: bool, entry: Entry) -> Batch {
        self.go_on(arrival);
        let due = Duration::try_from_secs_f64(self.elapsed / self.speed);
        Batch {
            due: due.unwrap_or(Duration::MAX),
            at: self.at.unwrap_or(0.0),
            is_first,
            entries: vec![entry],
        }
    }

    /// A clock that goes back has begun anew: what it shows then takes no time.
    fn go_on(&mut self, arrival: Option<f64>) {
        if let Some(arrival) = arrival {
            self.elapsed += self.at.map_or(0.0, |before| (arrival - before).max(0.0));
            self.at = Some(arrival);
        }
    }

    /// Whether there has been no sample.
    pub fn is_empty(&self) -> bool {
        self.at.is_none()
    }

    /// How it ended, in a sentence.
    pub fn farewell(&self) -> String {
        let ending = self.reader.ending();
        let seconds = ending.span.map_or(0.0, |(began, ended)| ended - began);
        let warning = self
            .reader
            .warning()
            .map(|warning| format!("warning: {warning}"));
        warning.unwrap_or_else(|| {
            let samples = ending.samples;
            format!("end of the recording: {samples} samples in {seconds:.1} s")
        })
    }
}
