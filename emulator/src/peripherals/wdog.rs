//! Watchdog timer (K20 manual, chapter 23): unlock window, write-once configuration, refresh sequence.

use crate::time::{self, NEVER, Ticks};
use crate::witness::Trap;

const STCTRLH: u32 = 0x00;
const STCTRLL: u32 = 0x02;
const TOVALH: u32 = 0x04;
const TOVALL: u32 = 0x06;
const WINH: u32 = 0x08;
const WINL: u32 = 0x0A;
const REFRESH: u32 = 0x0C;
const UNLOCK: u32 = 0x0E;
const TMROUTH: u32 = 0x10;
const TMROUTL: u32 = 0x12;
const RSTCNT: u32 = 0x14;
const PRESC: u32 = 0x16;

const WDOGEN: u16 = 1 << 0;
const CLKSRC_BUS: u16 = 1 << 1;
const WINEN: u16 = 1 << 3;
const ALLOWUPDATE: u16 = 1 << 4;

/// Bus cycles between the two words of a sequence (23.3.1, 23.4).
const SEQUENCE_CYCLES: u64 = 20;
/// The watchdog configuration time: bus cycles after reset or unlocking (23.3.2).
const CONFIGURATION_CYCLES: u64 = 256;
/// The low-power oscillator that may clock the counter.
const LPO_HZ: u32 = 1_000;

/// Registers that may be written once after each unlocking, in the order of `written`'s bits.
const CONFIGURATION: [u32; 6] = [STCTRLH, TOVALH, TOVALL, WINH, WINL, PRESC];

#[derive(Debug, Clone, Copy, PartialEq)]
enum Lock {
    /// After reset: the first unlock word has to come before this time.
    Fresh(Ticks),
    /// The first unlock word was written; the second has to come before this time.
    Half(Ticks),
    /// Configuration may be written, once a register, until this time.
    Open(Ticks),
    Closed,
}

/// The watchdog.
#[derive(Debug, Clone)]
pub struct Watchdog {
    stctrlh: u16,
    timeout: u32,
    window: u32,
    prescaler: u16,
    resets: u16,
    lock: Lock,
    /// One bit for each of [`CONFIGURATION`] written since the last unlocking.
    written: u8,
    /// The first refresh word was written; the second has to come before this time.
    refreshing: Option<Ticks>,
    counting_since: Ticks,
}

impl Watchdog {
    /// The state after a system reset at `now`; `resets` counts those the watchdog has caused since power-on.
    pub fn new(now: Ticks, bus_hz: u32, resets: u16) -> Watchdog {
        Watchdog {
            stctrlh: 0x01D3,
            timeout: 0x004C_4B4C,
            window: 0x10,
            prescaler: 0x0400,
            resets,
            lock: Lock::Fresh(now + time::of_cycles(CONFIGURATION_CYCLES, bus_hz)),
            written: 0,
            refreshing: None,
            counting_since: now,
        }
    }

    fn counter_hz(&self, bus_hz: u32) -> u32 {
        let source = if self.stctrlh & CLKSRC_BUS != 0 {
            bus_hz
        } else {
            LPO_HZ
        };
        source / (u32::from(self.prescaler >> 8 & 7) + 1)
    }

    fn deadline(&self, bus_hz: u32) -> Ticks {
        if self.stctrlh & WDOGEN == 0 {
            return NEVER;
        }
        self.counting_since + time::of_cycles(u64::from(self.timeout), self.counter_hz(bus_hz))
    }

    /// When [`Watchdog::expired`] has to be asked again.
    pub fn next_event(&self, bus_hz: u32) -> Ticks {
        let lock = match self.lock {
            Lock::Fresh(until) | Lock::Half(until) | Lock::Open(until) => until,
            Lock::Closed => NEVER,
        };
        lock.min(self.refreshing.unwrap_or(NEVER))
            .min(self.deadline(bus_hz))
    }

    /// Why the watchdog resets the chip at `now`, if it does.
    pub fn expired(&mut self, now: Ticks, bus_hz: u32) -> Option<Trap> {
        match self.lock {
            Lock::Fresh(until) if now >= until => {
                return Some(Trap::WatchdogNotUnlocked);
            }
            Lock::Half(until) if now >= until => {
                return Some(Trap::WatchdogUnlockSlow);
            }
            Lock::Open(until) if now >= until => {
                if self.written == 0 {
                    return Some(Trap::WatchdogNotConfigured);
                }
                self.lock = Lock::Closed;
            }
            _ => {}
        }
        if self.refreshing.is_some_and(|until| now >= until) {
            return Some(Trap::WatchdogRefreshSlow);
        }
        (now >= self.deadline(bus_hz)).then_some(Trap::WatchdogTimeout)
    }

    /// Reads a 16-bit register.
    pub fn read(&self, offset: u32, now: Ticks, bus_hz: u32) -> u32 {
        let elapsed = || {
            let ticks = u128::from(now.saturating_sub(self.counting_since));
            (ticks * u128::from(self.counter_hz(bus_hz)) / u128::from(time::SECOND)) as u32
        };
        match offset {
            STCTRLH => u32::from(self.stctrlh),
            STCTRLL => 1,
            TOVALH => self.timeout >> 16,
            TOVALL => self.timeout & 0xFFFF,
            WINH => self.window >> 16,
            WINL => self.window & 0xFFFF,
            REFRESH => 0xB480,
            UNLOCK => 0xD928,
            TMROUTH => elapsed() >> 16,
            TMROUTL => elapsed() & 0xFFFF,
            RSTCNT => u32::from(self.resets),
            PRESC => u32::from(self.prescaler),
            _ => 0,
        }
    }

    /// Writes a 16-bit register. An error is a broken rule: all but [`Trap::WatchdogLocked`] reset the chip.
    pub fn write(&mut self, offset: u32, value: u16, now: Ticks, bus_hz: u32) -> Result<(), Trap> {
        let soon = now + time::of_cycles(SEQUENCE_CYCLES, bus_hz);
        match offset {
            UNLOCK => match (value, self.lock) {
                (0xC520, Lock::Fresh(_)) => self.lock = Lock::Half(soon),
                (0xC520, _) if self.stctrlh & ALLOWUPDATE != 0 => self.lock = Lock::Half(soon),
                (0xC520, _) => return Err(Trap::WatchdogLocked),
                (0xD928, Lock::Half(_)) => {
                    self.lock = Lock::Open(now + time::of_cycles(CONFIGURATION_CYCLES, bus_hz));
                    self.written = 0;
                }
                _ => return Err(Trap::WatchdogUnlockSequence),
            },
            REFRESH => match (value, self.refreshing) {
                (0xA602, None) => self.refreshing = Some(soon),
                (0xB480, Some(_)) => {
                    let early = self.stctrlh & WINEN != 0
                        && now
                            < self.counting_since
                                + time::of_cycles(u64::from(self.window), self.counter_hz(bus_hz));
                    if early {
                        return Err(Trap::WatchdogRefreshEarly);
                    }
                    self.refreshing = None;
                    self.counting_since = now;
                }
                _ => return Err(Trap::WatchdogRefreshSequence),
            },
            RSTCNT => self.resets &= !value,
            _ => return self.configure(offset, value, now),
        }
        Ok(())
    }

    /// Writes outside the window, or a second time within it, are lost (23.3.2).
    fn configure(&mut self, offset: u32, value: u16, now: Ticks) -> Result<(), Trap> {
        let Some(index) = CONFIGURATION
            .iter()
            .position(|&register| register == offset)
        else {
            return Ok(());
        };
        let open = matches!(self.lock, Lock::Open(until) if now < until);
        if !open || self.written & 1 << index != 0 {
            return Err(Trap::WatchdogLocked);
        }
        self.written |= 1 << index;
        let word = u32::from(value);
        match offset {
            STCTRLH => self.stctrlh = value,
            TOVALH => self.timeout = word << 16 | self.timeout & 0xFFFF,
            TOVALL => self.timeout = self.timeout & 0xFFFF_0000 | word,
            WINH => self.window = word << 16 | self.window & 0xFFFF,
            WINL => self.window = self.window & 0xFFFF_0000 | word,
            _ => self.prescaler = value,
        }
        self.counting_since = now;
        Ok(())
    }
}
