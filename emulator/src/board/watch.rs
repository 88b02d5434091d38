//! Those who watch the board.

use std::io;

use super::Board;
use crate::image::Image;
use crate::journal::Happening;
use crate::time::Ticks;

/// Where the program is while something happens.
#[derive(Debug, Clone, Copy)]
pub struct Place<'a> {
    /// Address of the instruction.
    pub pc: u32,
    /// The image, which knows names.
    pub image: &'a Image,
}

/// Somebody who watches: a trace, a logic analyser.
pub trait Watcher: Send {
    /// Something has happened. Times do not always grow from call to call: what is told at its end began before.
    fn saw(&mut self, at: Ticks, happening: &Happening, place: Place<'_>);

    /// The run has ended at `at`; whether all of it could be written down.
    fn finish(&mut self, at: Ticks) -> io::Result<()>;
}

/// The board's watchers.
#[derive(Default)]
pub(super) struct Watch(Vec<Box<dyn Watcher>>);

impl std::fmt::Debug for Watch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} watchers", self.0.len())
    }
}

impl Watch {
    /// Whether anybody watches.
    pub fn is_on(&self) -> bool {
        !self.0.is_empty()
    }
}

/// What the board looks at to tell its watchers of changes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watched {
    exception: u16,
    /// How many handlers have begun and not ended.
    active: usize,
    stack: u32,
    asleep: bool,
    entries: u64,
}

impl Board {
    /// Lets `watcher` see everything that happens from now on. Copies of the board are not watched.
    pub fn watch(&mut self, watcher: Box<dyn Watcher>) {
        let mut chip = self.shared.chip();
        chip.journal.switch_on();
        chip.usb.journal.switch_on();
        drop(chip);
        self.watch.0.push(watcher);
    }

    /// Tells the watchers that the run has ended, and lets them go.
    ///
    /// # Errors
    ///
    /// The first error of one that could not write down what it saw.
    pub fn finish_watching(&mut self) -> io::Result<()> {
        self.tell_watchers(None);
        let ended = std::mem::take(&mut self.watch.0);
        ended
            .into_iter()
            .map(|mut watcher| watcher.finish(self.now))
            .fold(Ok(()), Result::and)
    }

    /// Hands over what was noted, and then what the board itself has seen now.
    pub(super) fn tell_watchers(&mut self, own: Option<Happening>) {
        if !self.watch.is_on() {
            return;
        }
        let mut notes = self.shared.chip().journal.take();
        notes.extend(own.map(|happening| (self.now, happening)));
        let place = Place {
            pc: self.pc,
            image: &self.image,
        };
        for (at, happening) in &notes {
            for watcher in &mut self.watch.0 {
                watcher.saw(*at, happening, place);
            }
        }
    }

    /// What the board itself looks at, before and after a step.
    pub(super) fn watched(&self) -> Watched {
        Watched {
            exception: self.cpu.exception(),
            active: self.active.len(),
            stack: self.cpu.stack_pointer(),
            asleep: self.cpu.is_asleep(),
            entries: self.measure.latencies.iter().map(|one| one.count).sum(),
        }
    }

    /// Tells the watchers what a step has changed.
    pub(super) fn tell_changes(&mut self, before: Watched) {
        self.tell_watchers(None);
        let after = self.watched();
        if before.asleep && !after.asleep {
            self.tell_watchers(Some(Happening::Asleep(false)));
        }
        let (from, to) = (before.exception, after.exception);
        let moved = from != to;
        let pushed = after.stack < before.stack;
        let chained = !moved && after.entries != before.entries;
        if from != 0 && (chained || moved && !pushed) {
            self.tell_watchers(Some(Happening::Left { exception: from }));
        }
        // From one handler back to the one it had interrupted.
        let returned = moved && after.active < before.active;
        if to != 0 && (moved || chained) && !returned {
            let waited = (after.entries != before.entries)
                .then_some(self.measure.waited)
                .flatten();
            self.tell_watchers(Some(Happening::Entered {
                exception: to,
                waited,
            }));
        }
        if !before.asleep && after.asleep {
            self.tell_watchers(Some(Happening::Asleep(true)));
        }
    }
}
