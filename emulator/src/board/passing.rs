//! How time passes on a board: with every instruction, in sleep, and in loops that only wait.

use super::Board;
use crate::cpu::Step;
use crate::time::{SECOND, Ticks};

/// From here on there are registers.
pub(super) const PERIPHERALS: u32 = 0x4000_0000;

impl Board {
    pub(super) fn look_for_polling(&mut self, step: &Step, until: Ticks) {
        let Some(polling) = &mut self.polling else {
            return;
        };
        if let Some(access) = step.access
            && access.address >= PERIPHERALS
            && (access.store || !self.shared.chip().is_steady(access.address))
        {
            polling.give_up();
            return;
        }
        let (before, after) = (self.cpu.registers_before(), self.cpu.registers());
        let Some(round) = polling.step(before, step.cycles, after) else {
            return;
        };
        let wake = self.next_event.min(until);
        let per_round = self.pace.of(round.cycles);
        let cycles = u128::from(wake.saturating_sub(self.now)) * u128::from(self.core_hz)
            / u128::from(SECOND);
        let cycles = (cycles as u64).min(self.cpu.cycles_to_systick().unwrap_or(u64::MAX));
        // The last round before the event is executed like any other.
        let rounds = (cycles / per_round).saturating_sub(1);
        if rounds > 0 {
            self.cpu.idle(rounds * per_round);
            self.pass(rounds * per_round);
            self.instructions += rounds * round.instructions;
            let mut sum = round.cycles;
            sum.least *= rounds;
            sum.greatest *= rounds;
            self.measure.awake(sum, self.core_hz);
        }
    }

    /// Sleeps until something happens; one idle step lets the processor look at its interrupts.
    pub(super) fn sleep(&mut self, until: Ticks) {
        let exception = self.cpu.exception();
        let step = self.cpu.step(self.flash_ratio);
        self.pass(self.pace.of(step.cycles));
        if !self.cpu.is_asleep() {
            let now_in = self.cpu.exception();
            if now_in != exception {
                self.change_exception(now_in, true);
            }
            return;
        }
        let wake = self.next_event.min(until);
        let Some(span) = wake.checked_sub(self.now).filter(|&span| span > 0) else {
            return;
        };
        let cycles =
            (u128::from(span) * u128::from(self.core_hz)).div_ceil(u128::from(SECOND)) as u64;
        let cycles = cycles
            .min(self.cpu.cycles_to_systick().unwrap_or(u64::MAX))
            .max(1);
        self.cpu.sleep(cycles);
        self.pass(cycles);
    }

    /// Lets `cycles` of the core pass.
    pub(super) fn pass(&mut self, cycles: u64) {
        let scaled = cycles * SECOND + self.remainder;
        let hz = u64::from(self.core_hz);
        self.remainder = scaled % hz;
        self.now += scaled / hz;
        self.shared.set_now(self.now);
    }
}
