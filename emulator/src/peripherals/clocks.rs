//! The clocks that a peripheral may run from, at one moment.

use crate::time::{self, Ticks};

/// The low-power oscillator (K20 data sheet: 1 kHz nominal).
pub const LPO_HZ: u32 = 1_000;
/// Crystal of the real-time clock, where one is fitted.
pub const RTC_HZ: u32 = 32_768;

/// The present moment and the frequencies in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Clocks {
    /// The moment.
    pub now: Ticks,
    /// Core and system clock (Hz).
    pub core_hz: u32,
    /// Bus clock (Hz).
    pub bus_hz: u32,
    /// MCGFFCLK, the fixed frequency clock of the timers (Hz).
    pub fixed_hz: u32,
    /// MCGIRCLK, the internal reference (Hz).
    pub internal_hz: u32,
    /// OSCERCLK, the crystal (Hz).
    pub crystal_hz: u32,
}

/// Whole cycles of a clock of `hz` that have passed in `span`.
pub fn cycles_in(span: Ticks, hz: u32) -> u64 {
    (u128::from(span) * u128::from(hz) / u128::from(time::SECOND)) as u64
}
