//! Clocks and time: 72 MHz core, 36 MHz bus, 24 MHz flash, and a count of milliseconds. The core may run at 36 MHz.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::{DCB, DWT};
use embedded_hal::delay::DelayNs;
use mk20dx_hal::clocks::McgExt;
use mk20dx_hal::pac;
use vrduino::command::request::CoreClock;

use super::timer;

/// Core cycles in a microsecond.
const CYCLES_PER_US: u32 = 72;

const TICKS_PER_MS: u32 = 1000 * timer::TICKS_PER_US;

static MILLISECONDS: AtomicU32 = AtomicU32::new(0);
/// The timer's count at the beginning of this millisecond.
static BEGAN: AtomicU32 = AtomicU32::new(0);

/// Milliseconds since start, as of the last sampling interrupt; wraps after 49 days.
pub fn milliseconds() -> u32 {
    MILLISECONDS.load(Ordering::Relaxed)
}

/// Counts the milliseconds that have passed; called by the alarm's interrupt, about once in each.
#[inline(always)]
pub(super) fn advance() {
    let began = BEGAN.load(Ordering::Relaxed);
    let passed = timer::now().wrapping_sub(began) / TICKS_PER_MS;
    // Only this interrupt writes, so load and store need not be one step.
    BEGAN.store(began.wrapping_add(passed * TICKS_PER_MS), Ordering::Relaxed);
    MILLISECONDS.store(milliseconds().wrapping_add(passed), Ordering::Relaxed);
}

/// Microseconds since start at the timer's count `now`, within the millisecond or behind it. Not to be interrupted by
/// the alarm.
pub(super) fn microseconds(now: u32) -> u64 {
    let since = now.wrapping_sub(BEGAN.load(Ordering::Relaxed)) / timer::TICKS_PER_US;
    u64::from(milliseconds()) * 1000 + u64::from(since)
}

/// Switches to the crystal and the PLL.
///
/// The HAL waits without a limit for each step; should one never come, the watchdog, which is already
/// running, starts the chip anew.
pub fn start(mut dcb: DCB, mut dwt: DWT, mcg: pac::Mcg, osc: pac::Osc, sim: &pac::Sim) {
    mcg.constrain().freeze(osc, sim);
    dcb.enable_trace();
    dwt.enable_cycle_counter();
}

/// The processor's clock. Bus, timers and USB keep theirs.
pub struct Core {
    sim: pac::Sim,
    clock: CoreClock,
}

impl Core {
    /// As [`start`] has left it.
    pub fn new(sim: pac::Sim) -> Core {
        let clock = CoreClock::Full;
        Core { sim, clock }
    }

    /// From now on so fast; not while something is written to flash.
    pub fn run_at(&mut self, clock: CoreClock) {
        if clock == self.clock {
            return;
        }
        self.clock = clock;
        // Divisors of the PLL's 72 MHz less one: core, bus, flash. Bus and flash clock have to be whole parts of the core's,
        // and the latter is 25 MHz at most (K20 manual, clock definitions).
        let (core, bus, flash) = match clock {
            CoreClock::Full => (0, 1, 2),
            CoreClock::Half => (1, 1, 3),
        };
        let dividers = core << 28 | bus << 24 | flash << 16;
        // SAFETY: the ratios are allowed, before, after and between.
        self.sim.clkdiv1().write(|w| unsafe { w.bits(dividers) });
    }
}

/// A moment in the near future that bounds a wait.
///
/// Counts core cycles, which stop while the core sleeps: for busy waits only. At half the clock it is twice as far.
#[derive(Clone, Copy)]
pub struct Deadline {
    start: u32,
    cycles: u32,
}

impl Deadline {
    /// `us` microseconds from now; at most 59 s.
    pub fn in_us(us: u32) -> Deadline {
        Deadline {
            start: DWT::cycle_count(),
            cycles: us * CYCLES_PER_US,
        }
    }

    /// Whether that moment has come.
    pub fn passed(self) -> bool {
        DWT::cycle_count().wrapping_sub(self.start) >= self.cycles
    }

    /// Waits for it.
    pub fn wait(self) {
        while !self.passed() {}
    }
}

/// Puts the core to sleep unless `ready`; the two are one step, so no wake-up is missed.
pub fn sleep_unless(ready: impl FnOnce() -> bool) {
    cortex_m::interrupt::free(|_| {
        if !ready() {
            // A pending interrupt ends WFI even while it is masked.
            cortex_m::asm::wfi();
        }
    });
}

/// Sleeps until `ready`, which an interrupt brings about; others wake the core for as short as can be.
#[inline(always)]
pub fn sleep_until(ready: impl Fn() -> bool) {
    cortex_m::interrupt::disable();
    while !ready() {
        // A pending interrupt ends WFI even while it is masked, and is served in the gap.
        cortex_m::asm::wfi();
        // SAFETY: no critical section surrounds this.
        unsafe { cortex_m::interrupt::enable() };
        cortex_m::asm::isb();
        cortex_m::interrupt::disable();
    }
    // SAFETY: as above.
    unsafe { cortex_m::interrupt::enable() };
}

/// Waiting, once the millisecond timer runs.
pub struct Time;

impl Time {
    /// Sleeps until the next millisecond.
    pub fn sleep_for_a_tick(&mut self) {
        let now = milliseconds();
        while milliseconds() == now {
            sleep_unless(|| milliseconds() != now);
        }
    }
}

impl DelayNs for Time {
    fn delay_ns(&mut self, ns: u32) {
        if ns >= 1_000_000 {
            // One more, since the current millisecond has already begun.
            for _ in 0..=ns.div_ceil(1_000_000) {
                self.sleep_for_a_tick();
            }
        } else {
            Deadline::in_us(ns.div_ceil(1000)).wait();
        }
    }
}
