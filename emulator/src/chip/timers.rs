//! The timers, and the pins of the FlexTimers.

use crate::peripherals::clocks::Clocks;
use crate::peripherals::ftm::FlexTimer;
use crate::peripherals::lptmr::LowPowerTimer;
use crate::peripherals::pdb::DelayBlock;
use crate::peripherals::pins::Pins;
use crate::peripherals::rtc::RealTimeClock;
use crate::time::{NEVER, Ticks};

/// Where a FlexTimer's channel comes out: timer, channel, port (A is 0), bit, and the pin's MUX (K20 manual, chapter
/// "Signal Multiplexing").
const PINS: [(usize, usize, usize, u32, u32); 17] = [
    (0, 0, 2, 1, 4),
    (0, 1, 2, 2, 4),
    (0, 2, 2, 3, 4),
    (0, 3, 2, 4, 4),
    (0, 4, 3, 4, 4),
    (0, 5, 3, 5, 4),
    (0, 6, 3, 6, 4),
    (0, 7, 3, 7, 4),
    (0, 0, 0, 3, 3),
    (0, 1, 0, 4, 3),
    (0, 2, 0, 5, 3),
    (1, 0, 0, 12, 3),
    (1, 1, 0, 13, 3),
    (1, 0, 1, 0, 3),
    (1, 1, 1, 1, 3),
    (2, 0, 1, 18, 3),
    (2, 1, 1, 19, 3),
];

/// FTM0 to FTM2, PDB, LPTMR and RTC.
#[derive(Debug, Clone)]
pub struct Timers {
    /// FTM0 to FTM2.
    pub flex: [FlexTimer; 3],
    /// The real-time clock.
    pub rtc: RealTimeClock,
    pub(super) delay: DelayBlock,
    pub(super) low_power: LowPowerTimer,
}

impl Timers {
    pub(super) fn new() -> Timers {
        Timers {
            flex: [FlexTimer::new(8), FlexTimer::new(2), FlexTimer::new(2)],
            rtc: RealTimeClock::new(),
            delay: DelayBlock::new(),
            low_power: LowPowerTimer::default(),
        }
    }

    /// A system reset; the real-time clock has its own supply and goes on.
    pub(super) fn reset(&mut self) {
        *self = Timers {
            rtc: self.rtc.clone(),
            ..Timers::new()
        };
    }

    pub(super) fn next_event(&self) -> Ticks {
        self.flex
            .iter()
            .map(FlexTimer::next_event)
            .fold(NEVER, Ticks::min)
            .min(self.delay.next_event())
            .min(self.low_power.next_event())
            .min(self.rtc.next_event())
    }

    /// Lets everything happen that is due, but for what the delay block triggers.
    pub(super) fn advance(&mut self, clocks: &Clocks) {
        for timer in &mut self.flex {
            if timer.next_event() <= clocks.now {
                timer.advance(clocks.now);
            }
        }
        if self.low_power.next_event() <= clocks.now {
            self.low_power.advance(clocks.now);
        }
        self.rtc.advance(clocks.now);
    }

    /// Whether a pin follows a timer.
    pub(super) fn reach_pins(&self, pins: &Pins) -> bool {
        PINS.iter()
            .any(|&(_, _, port, bit, mux)| pins.function(port, bit) == mux)
    }

    /// Puts the outputs of FlexTimers on the pins that are theirs.
    pub(super) fn show(&self, pins: &mut Pins, now: Ticks) {
        for (timer, channel, port, bit, mux) in PINS {
            if pins.function(port, bit) == mux {
                pins.set_peripheral_level(port, bit, self.flex[timer].level(channel, now));
            }
        }
    }

    /// An edge on a pin, for the channel that it belongs to.
    pub(super) fn edge(&mut self, pins: &Pins, at: (usize, u32), rising: bool, now: Ticks) {
        for (timer, channel, port, bit, mux) in PINS {
            if (port, bit) == at && pins.function(port, bit) == mux {
                self.flex[timer].edge(channel, rising, now);
            }
        }
    }
}
