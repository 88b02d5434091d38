//! What silicon does not forgive: the named traps, and where a program steps into one.
//!
//! A model that sees a program break a rule of the manual tells the [`Witness`]; [`crate::board`] turns that into a
//! [`Stop`], which says what was done, where, and what the manual says about it. A trap that was allowed becomes an
//! event instead, and the board goes on as silicon would: with a bus fault, a reset, or wrong data.

use crate::time::{self, Ticks};

pub use traps::Trap;

mod traps;

/// A rule was broken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Offence {
    /// Which one.
    pub trap: Trap,
    /// How, in words.
    pub what: String,
}

/// Collects what the models see, until the board looks at it.
#[derive(Debug, Clone, Default)]
pub struct Witness {
    seen: Vec<Offence>,
}

impl Witness {
    /// Notes that `trap` was stepped into, and how.
    pub fn saw(&mut self, trap: Trap, what: impl Into<String>) {
        /// A program that breaks a rule in a loop would fill the memory before the board looks.
        const KEPT: usize = 64;
        if self.seen.len() < KEPT {
            self.seen.push(Offence {
                trap,
                what: what.into(),
            });
        }
    }

    /// Whether there is anything to look at.
    pub fn is_empty(&self) -> bool {
        self.seen.is_empty()
    }

    /// Takes what was seen since the last call.
    pub fn take(&mut self) -> Vec<Offence> {
        std::mem::take(&mut self.seen)
    }
}

/// The end of a run: the program did what silicon does not forgive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stop {
    /// Which rule was broken.
    pub trap: Trap,
    /// How, in words.
    pub what: String,
    /// When.
    pub at: Ticks,
    /// Address of the instruction the processor was at.
    pub pc: u32,
    /// The same with the symbol it lies in, if the image has names.
    pub place: String,
}

impl std::fmt::Display for Stop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "stopped {}", self.trap)?;
        writeln!(f, "what    {}", self.what)?;
        writeln!(
            f,
            "where   {}, {:.6} s after power-on",
            self.place,
            time::seconds(self.at)
        )?;
        write!(f, "rule    {}", self.trap.rule())
    }
}
