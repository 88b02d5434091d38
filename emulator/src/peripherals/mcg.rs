//! Multipurpose clock generator with its oscillator (K20 manual, chapters 24 and 25): which clock drives the core.

use crate::time::{MICROSECOND, MILLISECOND, NEVER, Ticks};

/// The crystal on the board.
pub const CRYSTAL_HZ: u32 = 16_000_000;
/// FLL at reset: 640 × the 32 768 Hz internal reference (24.4.1).
const FLL_HZ: u32 = 32_768 * 640;
/// Slow internal reference.
const SLOW_IRC_HZ: u32 = 32_768;
/// Fast internal reference.
const FAST_IRC_HZ: u32 = 4_000_000;

/// Crystal start-up, data sheet "Oscillator electrical specifications" (8 MHz and up, low power): 0.6 ms typical.
const CRYSTAL_START: Ticks = MILLISECOND;
/// PLL lock time, data sheet: 150 µs + 1075 reference cycles; the slowest reference is 2 MHz.
const PLL_LOCK: Ticks = 688 * MICROSECOND;

const C1: usize = 0;
const C2: usize = 1;
const C5: usize = 4;
const C6: usize = 5;
const S: usize = 6;

/// The clock generator.
#[derive(Debug, Clone)]
pub struct ClockGenerator {
    registers: [u8; 14],
    /// When the crystal runs, once it was asked for.
    crystal_at: Ticks,
    /// When the PLL locks, once it was selected.
    pll_at: Ticks,
}

impl ClockGenerator {
    /// The state after reset: FEI, about 21 MHz.
    pub fn new() -> ClockGenerator {
        let mut registers = [0; 14];
        registers[C1] = 0x04;
        registers[C2] = 0x80;
        registers[8] = 0x02;
        registers[13] = 0x80;
        ClockGenerator {
            registers,
            crystal_at: NEVER,
            pll_at: NEVER,
        }
    }

    /// When the output may change by itself.
    pub fn next_event(&self, now: Ticks) -> Ticks {
        [self.crystal_at, self.pll_at]
            .into_iter()
            .filter(|&at| at > now)
            .min()
            .unwrap_or(NEVER)
    }

    fn crystal_runs(&self, now: Ticks) -> bool {
        now >= self.crystal_at
    }

    fn pll_runs(&self, now: Ticks) -> bool {
        self.crystal_runs(now) && now >= self.pll_at
    }

    /// CLKST as the status register shows it: 0 FLL, 1 internal, 2 external, 3 PLL.
    fn source(&self, now: Ticks) -> u8 {
        match self.registers[C1] >> 6 {
            0 if self.registers[C6] & 0x40 == 0 => 0,
            0 if self.pll_runs(now) => 3,
            1 => 1,
            2 if self.crystal_runs(now) => 2,
            // The switch waits for the clock that is not there yet.
            _ => 0,
        }
    }

    /// The PLL's output, if it has locked.
    pub fn pll_hz(&self, now: Ticks) -> Option<u32> {
        let divider = u32::from(self.registers[C5] & 0x1F) + 1;
        let multiplier = u32::from(self.registers[C6] & 0x1F) + 24;
        (self.registers[C6] & 0x40 != 0 && self.pll_runs(now))
            .then(|| CRYSTAL_HZ * multiplier / divider)
    }

    /// MCGOUTCLK.
    pub fn output_hz(&self, now: Ticks) -> u32 {
        match self.source(now) {
            1 if self.registers[C2] & 1 != 0 => FAST_IRC_HZ,
            1 => SLOW_IRC_HZ,
            2 => CRYSTAL_HZ,
            3 => self.pll_hz(now).unwrap_or(FLL_HZ),
            _ => FLL_HZ,
        }
    }

    /// MCGFFCLK, the FLL's reference: the crystal behind FRDIV, or the slow internal clock.
    pub fn fixed_hz(&self, now: Ticks) -> u32 {
        if self.registers[C1] & 0x04 != 0 || !self.crystal_runs(now) {
            return SLOW_IRC_HZ;
        }
        CRYSTAL_HZ
            / [32, 64, 128, 256, 512, 1024, 1280, 1536][usize::from(self.registers[C1] >> 3 & 7)]
    }

    /// MCGIRCLK: the slow internal clock, or half the fast one (FCRDIV is not looked at).
    pub fn internal_hz(&self) -> u32 {
        if self.registers[C2] & 1 != 0 {
            FAST_IRC_HZ / 2
        } else {
            SLOW_IRC_HZ
        }
    }

    fn status(&self, now: Ticks) -> u8 {
        let crystal = self.crystal_runs(now);
        let pll_selected = self.registers[C6] & 0x40 != 0;
        let internal_reference = self.registers[C1] & 0x04 != 0 || !crystal;
        u8::from(self.registers[C2] & 1 != 0)
            | u8::from(crystal) << 1
            | self.source(now) << 2
            | u8::from(internal_reference) << 4
            | u8::from(pll_selected) << 5
            | u8::from(pll_selected && self.pll_runs(now)) << 6
    }

    /// Reads an 8-bit register.
    pub fn read(&self, offset: u32, now: Ticks) -> u32 {
        match offset as usize {
            S => u32::from(self.status(now)),
            register => u32::from(self.registers.get(register).copied().unwrap_or(0)),
        }
    }

    /// Writes an 8-bit register.
    pub fn write(&mut self, offset: u32, value: u8, now: Ticks) {
        let register = offset as usize;
        if register == S || register >= self.registers.len() {
            return;
        }
        let pll_before = self.registers[C6] & 0x40 != 0;
        self.registers[register] = value;
        let wants_crystal = self.registers[C2] & 0x04 != 0 && self.registers[C1] & 0x04 == 0;
        if wants_crystal && self.crystal_at == NEVER {
            self.crystal_at = now + CRYSTAL_START;
        }
        let pll = self.registers[C6] & 0x40 != 0;
        if pll && !pll_before {
            self.pll_at = now.max(self.crystal_at) + PLL_LOCK;
        } else if !pll {
            self.pll_at = NEVER;
        }
    }
}

impl Default for ClockGenerator {
    fn default() -> ClockGenerator {
        ClockGenerator::new()
    }
}
