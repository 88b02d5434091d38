//! Touch sensing input (K20 manual, chapter "Touch Sensing Input (TSI)"): software-triggered scans of what lies at its
//! electrodes.

use crate::time::{MICROSECOND, NEVER, Ticks};

const GENCS: u32 = 0x000;
const SCANC: u32 = 0x004;
const PEN: u32 = 0x008;
const CNTR1: u32 = 0x100;
const CNTR15: u32 = 0x11C;

const EOSF: u32 = 1 << 15;
const SCNIP: u32 = 1 << 9;
const SWTS: u32 = 1 << 8;
const TSIEN: u32 = 1 << 7;
const TSIIE: u32 = 1 << 6;
const ESOR: u32 = 1 << 4;

/// The module.
#[derive(Debug, Clone)]
pub struct TouchSensing {
    control: u32,
    scan: u32,
    enabled: u32,
    counters: [u16; 16],
    ends: Ticks,
    /// Capacitance at each electrode (pF); an open pin has about 10.
    pub electrodes: [f64; 16],
}

impl TouchSensing {
    /// The state after reset.
    pub fn new() -> TouchSensing {
        TouchSensing {
            control: 0,
            scan: 0,
            enabled: 0,
            counters: [0; 16],
            ends: NEVER,
            electrodes: [10.0; 16],
        }
    }

    /// A system reset; what lies at the electrodes stays.
    pub fn reset(&mut self) {
        *self = TouchSensing {
            electrodes: self.electrodes,
            ..TouchSensing::new()
        };
    }

    /// Counts for electrode `n`: its oscillator's periods, `NSCN` times `PS`, timed by the reference oscillator.
    ///
    /// Both oscillators charge with currents of 2 µA steps, the reference one an internal 1 pF. Only the ratio is
    /// modelled: a real board's counts differ by its stray capacitance.
    fn counts(&self, n: usize) -> u16 {
        let (scans, prescaler) = (
            (self.control >> 19 & 0x1F) + 1,
            1u32 << (self.control >> 16 & 7),
        );
        let (reference, external) = ((self.scan >> 24 & 0xF) + 1, (self.scan >> 16 & 0xF) + 1);
        let ratio = self.electrodes[n] * f64::from(reference) / f64::from(external);
        (f64::from(scans * prescaler) * ratio)
            .round()
            .clamp(0.0, 65_535.0) as u16
    }

    /// When the running scan ends.
    pub fn next_event(&self) -> Ticks {
        self.ends
    }

    /// Ends the scan if its time has come.
    pub fn advance(&mut self, now: Ticks) {
        if self.ends <= now {
            self.ends = NEVER;
            for n in (0..16).filter(|n| self.enabled >> n & 1 != 0) {
                self.counters[n] = self.counts(n);
            }
            self.control |= EOSF;
        }
    }

    /// Whether the end of a scan asks for its interrupt.
    pub fn interrupt(&self) -> bool {
        self.control & (EOSF | TSIIE | ESOR) == EOSF | TSIIE | ESOR
    }

    /// Reads a 32-bit register; two electrodes share a counter register, and halves of it may be read.
    pub fn read(&self, offset: u32, width: u8) -> u32 {
        match offset {
            GENCS => self.control | if self.ends == NEVER { 0 } else { SCNIP },
            SCANC => self.scan,
            PEN => self.enabled,
            CNTR1..=CNTR15 | 0x11E => {
                let n = (offset - CNTR1) as usize / 2;
                let half = |n: usize| u32::from(self.counters.get(n).copied().unwrap_or(0));
                if width == 4 {
                    half(n) | half(n + 1) << 16
                } else {
                    half(n)
                }
            }
            _ => 0,
        }
    }

    /// Writes a 32-bit register.
    pub fn write(&mut self, offset: u32, value: u32, now: Ticks) {
        match offset {
            GENCS => {
                self.control =
                    value & !(SWTS | SCNIP | EOSF | 0x3000) | self.control & EOSF & !value;
                if value & TSIEN == 0 {
                    self.ends = NEVER;
                } else if value & SWTS != 0 {
                    // About as long as the core of a Teensy says: 10 µs for each pF.
                    let charge: f64 = (0..16)
                        .filter(|n| self.enabled >> n & 1 != 0)
                        .map(|n| self.electrodes[n])
                        .sum();
                    self.ends = now + (charge * 10.0) as Ticks * MICROSECOND;
                }
            }
            SCANC => self.scan = value,
            PEN => self.enabled = value & 0xFFFF,
            _ => {}
        }
    }
}

impl Default for TouchSensing {
    fn default() -> TouchSensing {
        TouchSensing::new()
    }
}
