//! The calibration that outlives the supply: a record in the store.

use core::fmt;

use vrduino::calibration::record::{Record, RecordError};
use vrduino::wire::{self, Line};

use super::store::{CAPACITY, Store, StoreError};

/// What is wrong with what was kept.
#[derive(Clone, Copy)]
enum Trouble {
    Store(StoreError),
    Record(RecordError),
    /// The newest is damaged.
    Older,
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Store(error) => write!(f, "no calibration: {error}"),
            Self::Record(error) => write!(f, "no calibration: {error}"),
            Self::Older => {
                f.write_str("the last calibration was not kept whole; using the one before")
            }
        }
    }
}

/// What is kept.
pub struct Calibration {
    store: Store,
    trouble: Option<Trouble>,
    next: Option<Record>,
}

impl Calibration {
    /// A calibration in `store`.
    pub fn new(store: Store) -> Calibration {
        Calibration {
            store,
            trouble: None,
            next: None,
        }
    }

    /// The record that was kept last, if there is a whole one.
    pub fn load(&mut self) -> Option<Record> {
        let mut bytes = [0; CAPACITY];
        let loaded = self.store.load(&mut bytes);
        self.trouble = match &loaded {
            Ok(loaded) => loaded.other_damaged.then_some(Trouble::Older),
            Err(StoreError::Empty) => None,
            Err(error) => Some(Trouble::Store(*error)),
        };
        let length = loaded.ok()?.length;
        let record = Record::from_bytes(bytes.get(..length).unwrap_or_default());
        record
            .inspect_err(|error| self.trouble = Some(Trouble::Record(*error)))
            .ok()
    }

    /// To be kept next, in the place of any other that has not begun to be.
    pub fn keep(&mut self, record: &Record) {
        self.next = Some(*record);
    }

    /// Whether there is something to keep.
    pub fn is_busy(&self) -> bool {
        self.next.is_some() || self.store.is_saving()
    }

    /// Goes on with it. Returns what the host is told once it has ended. To be called once in each turn
    /// of the main program; `now` is in milliseconds.
    pub fn serve(&mut self, now: u32) -> Option<Line> {
        let end = if self.store.is_saving() {
            self.store.serve(now)?
        } else {
            let record = self.next.take()?;
            match self.store.save(&record.to_bytes()) {
                Ok(()) => return None,
                error => error,
            }
        };
        Some(match end {
            Ok(()) => {
                self.trouble = None;
                wire::text("calibration kept")
            }
            Err(error) => wire::text(format_args!("error: calibration not kept: {error}")),
        })
    }

    /// What the host is told of what was found at start, if something is wrong.
    pub fn trouble(&self) -> Option<Line> {
        let trouble = self.trouble?;
        Some(wire::text(format_args!("warning: {trouble}")))
    }
}
