//! Two channels of the periodic interrupt timer (K20 manual, chapter 40), at the 36 MHz of the bus clock: one runs
//! freely and is the board's clock, the other is its alarm. Both run on while the core sleeps.

use mk20dx_hal::pac;

/// Ticks in a microsecond.
pub const TICKS_PER_US: u32 = 36;

const ALARM: usize = 0;
const CLOCK: usize = 1;

/// TCTRL: running, and with the interrupt.
const RUNNING: u32 = 1 << 0;
const RUNNING_WITH_INTERRUPT: u32 = 1 << 1 | 1 << 0;

fn registers() -> &'static pac::pit::RegisterBlock {
    // SAFETY: the timer is always there, and `start` has taken the only handle on it.
    unsafe { &*pac::Pit::PTR }
}

/// Starts the clock. The alarm is set by [`Alarm::set`].
pub fn start(_timer: pac::Pit, sim: &pac::Sim) -> Alarm {
    sim.scgc6().modify(|_, w| w.pit().enabled());
    // SAFETY: the module on, running on under a debugger.
    registers().mcr().write(|w| unsafe { w.bits(0) });
    // SAFETY: the longest period: it wraps where the count does.
    registers()
        .ldval(CLOCK)
        .write(|w| unsafe { w.bits(u32::MAX) });
    // SAFETY: no interrupt.
    registers()
        .tctrl(CLOCK)
        .write(|w| unsafe { w.bits(RUNNING) });
    Alarm(())
}

/// The clock: ticks since [`start`], which wrap after two minutes.
#[inline(always)]
pub fn now() -> u32 {
    !registers().cval(CLOCK).read().bits()
}

/// The alarm.
pub struct Alarm(());

impl Alarm {
    /// Interrupts in `ticks` ticks, in the place of any other moment that was set. To be set again in each interrupt,
    /// or it comes again after as many.
    #[inline(always)]
    pub fn set(&mut self, ticks: u32) {
        let timer = registers();
        // Only a timer that is switched off and on takes a new value at once (40.4.1.1).
        // SAFETY: off.
        timer.tctrl(ALARM).write(|w| unsafe { w.bits(0) });
        // SAFETY: any count will do.
        timer
            .ldval(ALARM)
            .write(|w| unsafe { w.bits(ticks.saturating_sub(1)) });
        // SAFETY: TIF is cleared by writing it as 1.
        timer.tflg(ALARM).write(|w| unsafe { w.bits(1) });
        // SAFETY: on.
        timer
            .tctrl(ALARM)
            .write(|w| unsafe { w.bits(RUNNING_WITH_INTERRUPT) });
    }
}
