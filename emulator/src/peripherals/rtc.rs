//! Real-time clock (K20 manual, chapter "Real Time Clock (RTC)"): a seconds counter on its own crystal and supply, so
//! that system resets leave it running.

use super::clocks::RTC_HZ;
use crate::time::{NEVER, SECOND, Ticks};

const TSR: u32 = 0x00;
const TPR: u32 = 0x04;
const TAR: u32 = 0x08;
const TCR: u32 = 0x0C;
const CR: u32 = 0x10;
const SR: u32 = 0x14;
const LR: u32 = 0x18;
const IER: u32 = 0x1C;

const OSCE: u32 = 1 << 8;
const SWR: u32 = 1 << 0;

const TCE: u32 = 1 << 4;
const TAF: u32 = 1 << 2;
const TOF: u32 = 1 << 1;
const TIF: u32 = 1 << 0;

/// Interrupt enables: TSIE for every second, the others as the flags.
const TSIE: u32 = 1 << 4;

/// The clock.
#[derive(Debug, Clone)]
pub struct RealTimeClock {
    /// Whether the 32.768 kHz crystal is on the board; a Teensy 3.2 comes without it.
    pub crystal_fitted: bool,
    seconds: u32,
    /// Prescaler at `since`: counts of the crystal within the second.
    prescaler: u32,
    alarm: u32,
    compensation: u32,
    control: u32,
    flags: u32,
    lock: u32,
    enables: u32,
    since: Ticks,
    second_passed: bool,
}

impl RealTimeClock {
    /// The state after power-on: time invalid.
    pub fn new() -> RealTimeClock {
        RealTimeClock {
            crystal_fitted: false,
            seconds: 0,
            prescaler: 0,
            alarm: 0,
            compensation: 0,
            control: 0,
            flags: TIF,
            lock: 0xFF,
            enables: 0x07,
            since: 0,
            second_passed: false,
        }
    }

    fn runs(&self) -> bool {
        self.crystal_fitted
            && self.control & OSCE != 0
            && self.flags & TCE != 0
            && self.flags & (TIF | TOF) == 0
    }

    /// How long this second is: compensation lengthens one second in each interval by up to 127 counts of the crystal.
    fn second_length(&self) -> Ticks {
        let (interval, counts) = (self.compensation >> 8 & 0xFF, self.compensation as u8 as i8);
        let counts = if self.seconds.is_multiple_of(interval + 1) {
            i64::from(counts)
        } else {
            0
        };
        SECOND.saturating_add_signed(-counts * SECOND as i64 / i64::from(RTC_HZ))
    }

    fn second_ends(&self) -> Ticks {
        let gone = u128::from(self.prescaler) * u128::from(SECOND) / u128::from(RTC_HZ);
        (self.since + self.second_length()).saturating_sub(gone as Ticks)
    }

    /// When the next second begins.
    pub fn next_event(&self) -> Ticks {
        if self.runs() {
            self.second_ends()
        } else {
            NEVER
        }
    }

    /// Counts the seconds that have passed.
    pub fn advance(&mut self, now: Ticks) {
        while self.runs() && self.second_ends() <= now {
            (self.since, self.prescaler) = (self.second_ends(), 0);
            self.second_passed = self.enables & TSIE != 0;
            self.flags |= if self.seconds == self.alarm { TAF } else { 0 };
            self.seconds = self.seconds.wrapping_add(1);
            self.flags |= if self.seconds == 0 { TOF } else { 0 };
        }
    }

    /// Whether invalid time, overflow or alarm ask for the alarm interrupt.
    pub fn alarm_interrupt(&self) -> bool {
        self.flags & self.enables & (TAF | TOF | TIF) != 0
    }

    /// Whether a second has passed; the pulse is gone once this was asked.
    pub fn take_second(&mut self) -> bool {
        std::mem::take(&mut self.second_passed)
    }

    fn prescaler_now(&self, now: Ticks) -> u32 {
        if self.runs() {
            let counts = u128::from(now.saturating_sub(self.since)) * u128::from(RTC_HZ)
                / u128::from(SECOND);
            (self.prescaler + counts as u32).min(RTC_HZ - 1)
        } else {
            self.prescaler
        }
    }

    /// Reads a 32-bit register.
    pub fn read(&self, offset: u32, now: Ticks) -> u32 {
        match offset {
            TSR => self.seconds,
            TPR => self.prescaler_now(now),
            TAR => self.alarm,
            TCR => self.compensation,
            CR => self.control,
            SR => self.flags,
            LR => self.lock,
            IER => self.enables,
            _ => 0,
        }
    }

    /// Writes a 32-bit register. The counters can be written only while they stand still.
    pub fn write(&mut self, offset: u32, value: u32, now: Ticks) {
        (self.prescaler, self.since) = (self.prescaler_now(now), now);
        let stopped = self.flags & TCE == 0;
        match offset {
            TSR if stopped => {
                self.seconds = value;
                self.flags &= !(TIF | TOF);
            }
            TPR if stopped => self.prescaler = value & 0x7FFF,
            TAR => {
                self.alarm = value;
                self.flags &= !TAF;
            }
            TCR => self.compensation = value & 0xFFFF,
            CR if value & SWR != 0 => {
                let crystal_fitted = self.crystal_fitted;
                *self = RealTimeClock {
                    crystal_fitted,
                    control: SWR,
                    ..RealTimeClock::new()
                };
            }
            CR => self.control = value & 0x3F0F,
            SR => self.flags = self.flags & !TCE | value & TCE,
            LR => self.lock &= value,
            IER => self.enables = value & 0x17,
            _ => {}
        }
    }
}

impl Default for RealTimeClock {
    fn default() -> RealTimeClock {
        RealTimeClock::new()
    }
}
