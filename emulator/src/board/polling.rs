//! Polling loops in which nothing can change before the next event.
//!
//! If the processor goes round twice with the same registers at every step, and has read nothing that changes by
//! itself, then it has read the same values and written the same values both times: the memory is as it was after the
//! first round, and every further round is the same, until something outside the processor happens. Such rounds are
//! counted instead of executed. No cycle count and no result differs, which a test proves.

use crate::cpu::op::Registers;
use crate::cpu::timing::Cycles;

/// The longest loop that is recognised, in instructions.
const LONGEST: usize = 256;
/// After this many looks in vain, the next look waits...
const PATIENCE: u32 = 2;
/// ... for this many instructions.
const PAUSE: u32 = 4096;

/// Registers and xPSR before an instruction.
type State = (Registers, u32);

/// One round of a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Round {
    /// How long it takes.
    pub cycles: Cycles,
    /// Its instructions.
    pub instructions: u64,
}

/// Watches for a loop.
#[derive(Debug, Clone, Default)]
pub(super) struct Polling {
    /// The first round, step by step, once it is complete; else as far as it got.
    steps: Vec<(State, Cycles)>,
    /// How far the second round has got.
    second: Option<usize>,
    vain: u32,
    pause: u32,
}

impl Polling {
    /// Something happened that a loop could not have known: begin anew.
    pub fn disturb(&mut self) {
        self.steps.clear();
        self.second = None;
        self.vain = 0;
        self.pause = 0;
    }

    /// Something that a loop may have read can have changed since it did.
    pub fn forget(&mut self) {
        self.steps.clear();
        self.second = None;
    }

    /// Takes in a step that began in `state`; says what a round is if the processor goes in circles, and stands at the
    /// beginning of one.
    pub fn step(
        &mut self,
        state: (&Registers, u32),
        cycles: Cycles,
        next: (&Registers, u32),
    ) -> Option<Round> {
        if self.pause > 0 {
            self.pause -= 1;
            return None;
        }
        if let Some(position) = self.second {
            let (known, took) = &self.steps[position];
            if (&known.0, known.1) != state || *took != cycles {
                self.give_up();
                return None;
            }
            if position + 1 < self.steps.len() {
                self.second = Some(position + 1);
                return None;
            }
            self.second = Some(0);
            if !self.is_first(next) {
                self.give_up();
                return None;
            }
            let mut sum = Cycles::default();
            for (_, cycles) in &self.steps {
                sum += *cycles;
            }
            return Some(Round {
                cycles: sum,
                instructions: self.steps.len() as u64,
            });
        }
        self.steps.push(((*state.0, state.1), cycles));
        if self.is_first(next) {
            self.second = Some(0);
        } else if self.steps.len() == LONGEST {
            self.give_up();
        }
        None
    }

    fn is_first(&self, (registers, xpsr): (&Registers, u32)) -> bool {
        let (first, _) = &self.steps[0];
        first.1 == xpsr && first.0 == *registers
    }

    /// A round cannot be told from what the processor does: it reached for something that may change by itself.
    pub fn give_up(&mut self) {
        if self.pause > 0 {
            return;
        }
        self.steps.clear();
        self.second = None;
        self.vain += 1;
        if self.vain >= PATIENCE {
            self.pause = PAUSE;
        }
    }
}
