//! What a board makes of the rules that a program breaks: a stop, or an event and what silicon would do.

use super::Board;
use crate::cpu::Fault;
use crate::time::{self, Ticks};
use crate::witness::{Offence, Stop, Trap};

/// Something worth telling, with the time it happened at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Event {
    /// When.
    pub at: Ticks,
    /// What, in a sentence.
    pub what: String,
}

impl std::fmt::Display for Event {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:9.4} s  {}", time::seconds(self.at), self.what)
    }
}

/// Entries of one exception since the program last got anywhere.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Storm {
    pub exception: u16,
    pub entries: u32,
    /// The handler's first instruction.
    pub handler: u32,
}

impl Board {
    /// Stops at the first offence that is not allowed; the others become events.
    pub(super) fn judge(&mut self, offences: Vec<Offence>) {
        let place = self.place();
        for Offence { trap, what } in offences {
            if self.allowed.contains(&trap) {
                let what = format!("{trap}: {what}; at {place}");
                self.tell(what);
            } else {
                self.stop.get_or_insert(Stop {
                    trap,
                    what,
                    at: self.now,
                    pc: self.pc,
                    place: place.clone(),
                });
            }
        }
    }

    /// Why the board runs no more, if it stepped into a trap that was not allowed.
    pub fn stop(&self) -> Option<&Stop> {
        self.stop.as_ref()
    }

    pub(super) fn enter(&mut self, exception: u16) {
        /// So many entries without a single instruction of the program between them are no accident.
        const STORM: u32 = 20_000;
        if let Some(number) = exception.checked_sub(16) {
            self.measure.entered(number, self.now);
        }
        let entries = if self.storm.exception == exception {
            self.storm.entries + 1
        } else {
            1
        };
        self.storm = Storm {
            exception,
            entries,
            handler: self.cpu.pc(),
        };
        if entries == STORM {
            let what = format!(
                "exception {exception} was taken {STORM} times, and the program did not get anywhere between"
            );
            self.judge(vec![Offence {
                trap: Trap::InterruptStorm,
                what,
            }]);
        }
    }

    /// The main stack has never been this deep.
    pub(super) fn lower_stack(&mut self, stack: u32) {
        let before = std::mem::replace(&mut self.measure.stack_low, stack);
        if stack < self.stack_limit && before >= self.stack_limit {
            let what = format!(
                "the stack pointer is {stack:#010x}, but variables end at {:#010x}",
                self.stack_limit
            );
            self.judge(vec![Offence {
                trap: Trap::StackIntoData,
                what,
            }]);
        }
    }

    /// A fault on the peripheral bridges has been told by who saw it there.
    pub(super) fn take_fault(&mut self, fault: Fault) {
        let told = !self.shared.chip().witness.is_empty();
        if fault.trap == Trap::Breakpoint && self.calls_loader() {
            self.enter_loader();
        } else if !told {
            self.judge(vec![Offence {
                trap: fault.trap,
                what: fault.what,
            }]);
        }
    }

    /// Where the program is, for people; outside all symbols also where it came from, as far as the link register tells.
    fn place(&self) -> String {
        const CODE: std::ops::Range<u32> = 1..0x4000_0000;
        let (place, link) = (self.place_of(self.pc), self.cpu.registers_before().0[14]);
        if self.image.symbol_at(self.pc).is_some() || !CODE.contains(&link) {
            return place;
        }
        format!(
            "{place}; the link register holds {}",
            self.place_of(link & !1)
        )
    }

    /// An address for people.
    pub(super) fn place_of(&self, pc: u32) -> String {
        match self.image.symbol_at(pc) {
            Some((name, offset)) => format!("{pc:#010x} ({name} + {offset:#x})"),
            None => format!("{pc:#010x}"),
        }
    }

    /// Notes an event. A program that is reset again and again would fill the memory before anybody looks.
    pub(super) fn tell(&mut self, what: String) {
        const KEPT: usize = 1_000;
        if self.events.len() < KEPT {
            self.events.push(Event { at: self.now, what });
        }
    }

    /// Takes what happened since the last call; after a thousand events the rest is left out.
    pub fn take_events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.events)
    }
}
