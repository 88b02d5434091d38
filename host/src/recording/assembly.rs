//! Items of the stream put together to entries of a recording.

use super::{Entry, Remark, Row, Voice};
use crate::stream::{Item, Sample};

/// Puts a sample and its registers, which come behind it, into one row.
#[derive(Debug, Default)]
pub struct Assembly {
    with_counts: bool,
    /// Its registers may be next.
    waiting: Option<Sample>,
    /// When the latest sample came, in s on the source's clock.
    now: f64,
    /// Whether the latest sample had a number: times of samples with and without do not go together.
    numbered: Option<bool>,
}

impl Assembly {
    /// With the sensor's registers, or without.
    pub fn new(with_counts: bool) -> Self {
        Self {
            with_counts,
            ..Self::default()
        }
    }

    /// Takes an item; what is complete becomes entries.
    pub fn take(&mut self, item: &Item, entries: &mut Vec<Entry>) {
        match item {
            Item::Sample(sample) => {
                self.complete(entries);
                let numbered = sample.sequence.is_some();
                let changed = self.numbered.replace(numbered) != Some(numbered);
                let mut sample = *sample;
                sample.is_first |= changed;
                self.now = sample.arrival;
                self.waiting = Some(sample);
                if !self.with_counts {
                    self.complete(entries);
                }
            }
            Item::Registers(registers) => {
                let of_it = |sample: &Sample| sample.sequence == Some(registers.sequence);
                if let Some(sample) = self.waiting.take_if(|sample| of_it(sample)) {
                    let registers = Some(registers.counts);
                    entries.push(Entry::Row(Row { sample, registers }));
                }
            }
            Item::Line(line) => {
                self.complete(entries);
                entries.push(Entry::Remark(Remark::new(self.now, Voice::Board, line)));
            }
        }
    }

    /// No more registers will come for the latest sample.
    pub fn complete(&mut self, entries: &mut Vec<Entry>) {
        if let Some(sample) = self.waiting.take() {
            let registers = None;
            entries.push(Entry::Row(Row { sample, registers }));
        }
    }

    /// A remark of whoever records.
    pub fn note(&mut self, text: &str, entries: &mut Vec<Entry>) {
        self.complete(entries);
        let remark = Remark::new(self.now, Voice::Recorder, text);
        entries.push(Entry::Remark(remark));
    }

    /// What comes next is the first of a recording, whatever came before.
    pub fn begin_anew(&mut self) {
        self.numbered = None;
    }
}
