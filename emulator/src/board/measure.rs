//! What a run is measured by: processor load, interrupt latency, depth of the stack, time in one function.

use crate::chip::INTERRUPTS;
use crate::cpu::timing::Cycles;
use crate::time::{SECOND, Ticks};

/// How long an interrupt waits for its handler.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Latency {
    /// How often its handler was entered.
    pub count: u64,
    /// The longest time from the request to the handler's first instruction.
    pub worst: Ticks,
    requested: Option<Ticks>,
}

/// Calls of one function, without the interrupts that came between.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Calls {
    /// How many have returned.
    pub count: u64,
    /// Instructions of all of them.
    pub instructions: u64,
    /// Most instructions of one.
    pub most_instructions: u64,
    /// Cycles of all of them.
    pub cycles: Cycles,
    /// Cycles of the longest.
    pub worst: Cycles,
}

/// One call that has not returned yet.
#[derive(Debug, Clone, Copy)]
struct Call {
    returns_to: u32,
    stack: u32,
    exception: u16,
    instructions: u64,
    cycles: Cycles,
}

/// The measurements of a run.
#[derive(Debug, Clone)]
pub struct Measure {
    /// Time awake, by both ends of the band, in ticks.
    pub awake: Cycles,
    /// The lowest main stack pointer so far.
    pub stack_low: u32,
    /// One for each of the chip's interrupts.
    pub latencies: [Latency; INTERRUPTS.len()],
    /// The timed function's calls.
    pub calls: Calls,
    /// What is left of `awake`, in ticks × hertz.
    rest: Cycles,
    /// How long the interrupt that was entered last had waited.
    pub(super) waited: Option<Ticks>,
    timed: Option<u32>,
    call: Option<Call>,
}

/// What the processor was at when a step began, and where it is now.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    pub pc: u32,
    pub exception: u16,
    pub stack: u32,
    pub link: u32,
    pub next: u32,
    pub next_stack: u32,
}

impl Measure {
    /// Nothing measured yet; `timed` is the address of the function whose calls are timed.
    pub fn new(timed: Option<u32>) -> Measure {
        Measure {
            awake: Cycles::default(),
            stack_low: u32::MAX,
            latencies: [Latency::default(); INTERRUPTS.len()],
            calls: Calls::default(),
            rest: Cycles::default(),
            waited: None,
            timed,
            call: None,
        }
    }

    /// Takes in `count` equal steps of the processor awake.
    pub(super) fn awake(&mut self, cycles: Cycles, hz: u32) {
        let hz = u64::from(hz);
        let ticks = |cycles: u64, rest: &mut u64| {
            let scaled = cycles * SECOND + *rest;
            *rest = scaled % hz;
            scaled / hz
        };
        self.awake += Cycles {
            least: ticks(cycles.least, &mut self.rest.least),
            greatest: ticks(cycles.greatest, &mut self.rest.greatest),
        };
    }

    /// Follows the timed function.
    pub(super) fn follow(&mut self, moment: &Moment, cycles: Cycles) {
        match &mut self.call {
            None if Some(moment.pc) == self.timed => {
                self.call = Some(Call {
                    returns_to: moment.link & !1,
                    stack: moment.stack,
                    exception: moment.exception,
                    instructions: 1,
                    cycles,
                });
            }
            Some(call) if call.exception == moment.exception => {
                call.instructions += 1;
                call.cycles += cycles;
            }
            _ => return,
        }
        if let Some(call) = self.call
            && call.returns_to == moment.next
            && call.stack == moment.next_stack
        {
            self.call = None;
            self.calls.count += 1;
            self.calls.instructions += call.instructions;
            self.calls.most_instructions = self.calls.most_instructions.max(call.instructions);
            self.calls.cycles += call.cycles;
            self.calls.worst.least = self.calls.worst.least.max(call.cycles.least);
            self.calls.worst.greatest = self.calls.worst.greatest.max(call.cycles.greatest);
        }
    }

    /// Interrupt line `index` was raised or lowered.
    pub(super) fn line(&mut self, index: usize, asserted: bool, now: Ticks) {
        self.latencies[index].requested = asserted.then_some(now);
    }

    /// The handler of interrupt `number` begins.
    pub(super) fn entered(&mut self, number: u16, now: Ticks) {
        self.waited = None;
        let Some(index) = INTERRUPTS.iter().position(|&known| known == number) else {
            return;
        };
        let latency = &mut self.latencies[index];
        latency.count += 1;
        if let Some(requested) = latency.requested.take() {
            self.waited = Some(now - requested);
            latency.worst = latency.worst.max(now - requested);
        }
    }

    /// After a reset: a call that was under way never returns.
    pub(super) fn reset(&mut self) {
        self.call = None;
        for latency in &mut self.latencies {
            latency.requested = None;
        }
    }
}
