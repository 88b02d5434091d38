//! The board's second chip, which brings new images into the flash.

use super::{Board, Event};
use crate::peripherals::rcm::Cause;
use crate::time::Ticks;

impl Board {
    /// Whether the breakpoint is one that PJRC's cores reboot with, by its immediate: BKPT #0 on Teensy 3, #251 since.
    pub(super) fn calls_loader(&self) -> bool {
        matches!(self.cpu.halfword(self.pc), Some(0xBE00 | 0xBEFB))
    }

    /// A breakpoint halts the processor, because the board's loader chip is a debugger that never lets go of it. The
    /// loader then takes the board over: whatever ran is gone, and the board leaves the USB as what it was.
    pub(super) fn enter_loader(&mut self) {
        let place = self.place_of(self.pc);
        let what =
            format!("the board went into its loader, by BKPT at {place}: it waits for a new image");
        self.events.push(Event { at: self.now, what });
        self.loader = Some(self.now);
        let mut chip = self.shared.chip();
        chip.reset(Cause::Software);
        chip.advance();
    }

    /// Since when the board is in its loader, if the program has sent it there. Nothing of the image runs any more.
    pub fn in_loader(&self) -> Option<Ticks> {
        self.loader
    }
}
