//! What the processor and the chip share.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard};

use crate::chip::Chip;
use crate::cpu::PeripheralBus;
use crate::time::Ticks;

/// The chip behind a lock, since the processor holds its own while it reaches for a register.
#[derive(Debug)]
pub(super) struct Shared {
    chip: Mutex<Chip>,
    now: AtomicU64,
    touched: AtomicBool,
}

impl Shared {
    pub fn new(chip: Chip) -> Shared {
        Shared {
            chip: Mutex::new(chip),
            now: AtomicU64::new(0),
            touched: AtomicBool::new(true),
        }
    }

    /// The chip at the present moment.
    pub fn chip(&self) -> MutexGuard<'_, Chip> {
        let mut chip = self
            .chip
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        chip.now = self.now.load(Ordering::Relaxed);
        chip
    }

    pub fn set_now(&self, now: Ticks) {
        self.now.store(now, Ordering::Relaxed);
    }

    /// A register was touched, so events and interrupts have to be looked at again.
    pub fn touch(&self) {
        self.touched.store(true, Ordering::Relaxed);
    }

    pub fn is_touched(&self) -> bool {
        self.touched.load(Ordering::Relaxed)
    }

    /// Somebody looks at events and interrupts now.
    pub fn look(&self) {
        self.touched.store(false, Ordering::Relaxed);
    }
}

impl PeripheralBus for Shared {
    fn read(&self, address: u32, width: u8) -> Option<u32> {
        self.touch();
        let mut chip = self.chip();
        let value = chip.read(address, width);
        if chip.journal.is_on() {
            chip.note_access(address, width, value, false);
        }
        value
    }

    fn write(&self, address: u32, width: u8, value: u32) -> bool {
        self.touch();
        let mut chip = self.chip();
        let accepted = chip.write(address, width, value);
        if chip.journal.is_on() {
            chip.note_access(address, width, accepted.then_some(value), true);
        }
        accepted
    }
}
