//! Low-power timer (K20 manual, chapter "Low-Power Timer (LPTMR)") in its time-counter mode.

use super::clocks::{Clocks, LPO_HZ, cycles_in};
use crate::time::{self, NEVER, Ticks};

const TCF: u32 = 1 << 7;
const TIE: u32 = 1 << 6;
const TMS: u32 = 1 << 1;
const TFC: u32 = 1 << 2;
const TEN: u32 = 1 << 0;
const PBYP: u32 = 1 << 2;

/// The timer.
#[derive(Debug, Clone, Default)]
pub struct LowPowerTimer {
    control: u32,
    prescale: u32,
    compare: u32,
    flag: bool,
    /// What a read of the counter shows: it is latched by a write.
    latched: u32,
    since: Ticks,
    /// Frequency of the counter; 0 while it stands still.
    hz: u32,
    seen: Ticks,
}

impl LowPowerTimer {
    /// Counts of a period: back to 0 after the compare value, or free running.
    fn period(&self) -> u64 {
        if self.control & TFC != 0 {
            0x1_0000
        } else {
            u64::from(self.compare) + 1
        }
    }

    fn counter(&self, now: Ticks) -> u32 {
        (cycles_in(now.saturating_sub(self.since), self.hz) % self.period()) as u32
    }

    /// When the counter next leaves the compare value.
    fn next_match(&self) -> Ticks {
        if self.hz == 0 {
            return NEVER;
        }
        let done = cycles_in(self.seen.saturating_sub(self.since), self.hz);
        let target = (u64::from(self.compare) + 1) % self.period();
        let ahead = (target + self.period() - done % self.period()) % self.period();
        let ahead = if ahead == 0 { self.period() } else { ahead };
        self.since + time::of_cycles(done + ahead, self.hz)
    }

    /// When the flag is set next.
    pub fn next_event(&self) -> Ticks {
        if self.flag { NEVER } else { self.next_match() }
    }

    /// Sets the flag if the compare value was passed.
    pub fn advance(&mut self, now: Ticks) {
        if self.hz == 0 {
            return;
        }
        self.flag |= self.next_match() <= now;
        self.seen = now;
    }

    /// Whether the timer asks for its interrupt.
    pub fn interrupt(&self) -> bool {
        self.flag && self.control & TIE != 0
    }

    /// Reads a 32-bit register.
    pub fn read(&self, offset: u32) -> u32 {
        match offset {
            0x0 => self.control | if self.flag { TCF } else { 0 },
            0x4 => self.prescale,
            0x8 => self.compare,
            0xC => self.latched,
            _ => 0,
        }
    }

    /// Writes a 32-bit register.
    pub fn write(&mut self, offset: u32, value: u32, clocks: &Clocks) {
        match offset {
            0x0 => {
                let started = value & TEN != 0 && self.control & TEN == 0;
                self.flag &= value & (TCF) == 0 && value & TEN != 0;
                self.control = value & 0x7F;
                if value & TEN == 0 {
                    (self.hz, self.latched) = (0, 0);
                } else if started {
                    (self.since, self.seen) = (clocks.now, clocks.now);
                    self.hz = if value & TMS != 0 {
                        0
                    } else {
                        self.clock_hz(clocks)
                    };
                }
            }
            0x4 => self.prescale = value & 0x7F,
            0x8 => self.compare = value & 0xFFFF,
            0xC => {
                self.latched = if self.hz == 0 {
                    0
                } else {
                    self.counter(clocks.now)
                }
            }
            _ => {}
        }
    }

    /// The clock behind the prescaler. The 32 kHz clock is not there: a Teensy 3.2 comes without its crystal.
    fn clock_hz(&self, clocks: &Clocks) -> u32 {
        let source = match self.prescale & 3 {
            0 => clocks.internal_hz,
            1 => LPO_HZ,
            2 => 0,
            _ => clocks.crystal_hz,
        };
        if self.prescale & PBYP != 0 {
            source
        } else {
            source >> ((self.prescale >> 3 & 0xF) + 1)
        }
    }
}
