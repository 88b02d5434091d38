//! SysTick and DWT_CYCCNT, which the engine counts by its own idea of cycles: here they are made right.
//!
//! The difference is made up for before anybody looks, and before SysTick can expire, so that neither depends on when
//! it was made up for.

use rsemu::cpu::arm::v7m::sys::{Exception, Sys};

use super::Cpu;

/// What DWT_CYCCNT and SysTick have yet to count, or have counted too much: the engine has its own idea of cycles.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Owed {
    pub cycle_counter: i64,
    pub systick: i64,
}

impl Cpu {
    /// A step took `cycles`, and the engine has counted `charged`.
    pub(super) fn owe(&mut self, cycles: u64, charged: u64) {
        let owed = cycles as i64 - charged as i64;
        self.owed.cycle_counter += owed;
        self.owed.systick += owed;
        self.calm = self.calm.saturating_sub(cycles.max(charged));
        if self.calm == 0 {
            self.settle();
        }
    }

    /// Lets DWT_CYCCNT and SysTick count what they are owed.
    pub(super) fn settle(&mut self) {
        /// No instruction takes as long.
        const STEP: u64 = 128;
        /// How long nobody has to look at counters that do not expire.
        const LONG: u64 = 1 << 20;
        if !self.counting {
            self.owed = Owed::default();
            return;
        }
        let mut owed = self.owed;
        self.calm = self.core.with_sys(|sys| {
            settle(sys, &mut owed);
            match sys.syst_csr & 1 {
                0 => LONG,
                _ => u64::from(sys.syst_cvr).saturating_sub(STEP),
            }
        });
        self.owed = owed;
    }

    /// Somebody may have started or stopped a counter.
    pub(super) fn look_at_counters(&mut self) {
        self.calm = 0;
        self.counting = self
            .core
            .with_sys(|sys| sys.syst_csr & 1 != 0 || sys.cyccnt_enabled());
    }

    /// Cycles until SysTick would pend its exception, 0 if it has; `None` if it never will.
    pub fn cycles_to_systick(&mut self) -> Option<u64> {
        self.settle();
        self.core.with_sys(|sys| {
            let (enabled, interrupt) = (sys.syst_csr & 1 != 0, sys.syst_csr & 2 != 0);
            (enabled && interrupt && sys.syst_rvr != 0).then(|| match sys.syst_cvr {
                _ if sys.is_pending(Exception::SYSTICK) => 0,
                0 => u64::from(sys.syst_rvr) + 1,
                count => u64::from(count),
            })
        })
    }

    /// Lets `cycles` pass in sleep: SysTick counts on, DWT_CYCCNT does not (its clock is gated by WFI).
    pub fn sleep(&mut self, cycles: u64) {
        self.calm = 0;
        self.core.with_sys(|sys| count_systick(sys, cycles));
    }

    /// Lets `cycles` pass awake: both counters count.
    pub fn idle(&mut self, cycles: u64) {
        self.calm = 0;
        self.core.with_sys(|sys| {
            sys.tick_cyccnt(cycles);
            count_systick(sys, cycles);
        });
    }
}

fn count_systick(sys: &mut Sys, cycles: u64) {
    if sys.tick_systick(cycles) && sys.syst_csr & 2 != 0 {
        sys.set_pending(Exception::SYSTICK, true);
    }
}

/// Makes the counters right. SysTick is not turned back over its reload, lest it expire twice: what is left waits.
pub(super) fn settle(sys: &mut Sys, owed: &mut Owed) {
    let counter = std::mem::take(&mut owed.cycle_counter);
    if sys.cyccnt_enabled() {
        sys.dwt_cyccnt = sys.dwt_cyccnt.wrapping_add(counter as u32);
    }
    if sys.syst_csr & 1 == 0 || sys.syst_rvr == 0 {
        owed.systick = 0;
    } else if owed.systick > 0 {
        count_systick(sys, std::mem::take(&mut owed.systick) as u64);
    } else if sys.syst_cvr != 0 {
        // At zero it has expired.
        let room = i64::from(sys.syst_rvr.saturating_sub(sys.syst_cvr));
        let back = room.min(-owed.systick);
        sys.syst_cvr += back as u32;
        owed.systick += back;
    }
}
