//! Multipurpose clock generator with its oscillator (K20 manual, chapters 24 and 25): which clock drives the core, and
//! which ways lead from one mode to another.

use crate::time::{MICROSECOND, MILLISECOND, NEVER, Ticks};
use crate::witness::{Trap, Witness};

/// The crystal on the board.
pub const CRYSTAL_HZ: u32 = 16_000_000;
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
const C4: usize = 3;
const C5: usize = 4;
const C6: usize = 5;
const S: usize = 6;

const IREFS: u8 = 1 << 2;
const LP: u8 = 1 << 1;
const EREFS: u8 = 1 << 2;
const DMX32: u8 = 1 << 7;
const PLLS: u8 = 1 << 6;
const PLLCLKEN: u8 = 1 << 6;

/// Divides the crystal for the FLL, by FRDIV, where RANGE is not 0 (MCG_C1).
const FLL_DIVIDER: [u32; 8] = [32, 64, 128, 256, 512, 1024, 1280, 1536];
/// What the FLL's reference may be (MCG_C1[FRDIV]).
const FLL_REFERENCE_HZ: std::ops::RangeInclusive<u32> = 31_250..=39_063;
/// What the PLL's reference may be (data sheet, MCG specifications).
const PLL_REFERENCE_HZ: std::ops::RangeInclusive<u32> = 2_000_000..=4_000_000;

/// Modes of operation (K20 manual, MCG, modes of operation).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    Fei,
    Fee,
    Fbi,
    Fbe,
    Blpi,
    Blpe,
    Pbe,
    Pee,
}

impl Mode {
    /// The mode that these registers ask for; `None` if they contradict each other.
    fn of(c1: u8, c2: u8, c6: u8) -> Option<Mode> {
        let low_power = c2 & LP != 0;
        match (c1 >> 6, c1 & IREFS != 0, c6 & PLLS != 0) {
            (0, true, false) => Some(Mode::Fei),
            (0, false, false) => Some(Mode::Fee),
            (0, false, true) => Some(Mode::Pee),
            (1, true, false) if low_power => Some(Mode::Blpi),
            (1, true, false) => Some(Mode::Fbi),
            (2, false, _) if low_power => Some(Mode::Blpe),
            (2, false, false) => Some(Mode::Fbe),
            (2, false, true) => Some(Mode::Pbe),
            _ => None,
        }
    }

    /// The modes that can be entered from here (K20 manual, MCG mode state diagram).
    fn neighbours(self) -> &'static [Mode] {
        use Mode::{Blpe, Blpi, Fbe, Fbi, Fee, Fei, Pbe, Pee};
        match self {
            Fei => &[Fee, Fbi, Fbe],
            Fee => &[Fei, Fbi, Fbe],
            Fbi => &[Fei, Fee, Fbe, Blpi],
            Fbe => &[Fei, Fee, Fbi, Blpe, Pbe],
            Blpi => &[Fbi],
            Blpe => &[Fbe, Pbe],
            Pbe => &[Fbe, Blpe, Pee],
            Pee => &[Pbe],
        }
    }
}

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
            0 if self.registers[C6] & PLLS == 0 => 0,
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
        (self.registers[C6] & PLLS != 0 && self.pll_runs(now))
            .then(|| CRYSTAL_HZ * multiplier / divider)
    }

    /// MCGOUTCLK.
    pub fn output_hz(&self, now: Ticks) -> u32 {
        match self.source(now) {
            1 if self.registers[C2] & 1 != 0 => FAST_IRC_HZ,
            1 => SLOW_IRC_HZ,
            2 => CRYSTAL_HZ,
            3 => self.pll_hz(now).unwrap_or(SLOW_IRC_HZ),
            _ => self.fll_hz(now),
        }
    }

    /// MCGFFCLK, the FLL's reference: the crystal behind FRDIV, or the slow internal clock.
    pub fn fixed_hz(&self, now: Ticks) -> u32 {
        if self.registers[C1] & IREFS != 0 || !self.crystal_runs(now) {
            return SLOW_IRC_HZ;
        }
        self.fll_reference()
    }

    /// MCGIRCLK: the slow internal clock, or half the fast one (FCRDIV is not looked at).
    pub fn internal_hz(&self) -> u32 {
        if self.registers[C2] & 1 != 0 {
            FAST_IRC_HZ / 2
        } else {
            SLOW_IRC_HZ
        }
    }

    /// The FLL's output: 640 times its reference, or more by C4 (MCG_C4[DRST_DRS]).
    fn fll_hz(&self, now: Ticks) -> u32 {
        let external = self.registers[C1] & IREFS == 0 && self.crystal_runs(now);
        let reference = if external {
            self.fll_reference()
        } else {
            SLOW_IRC_HZ
        };
        let range = u32::from(self.registers[C4] >> 5 & 3) + 1;
        let factor = if self.registers[C4] & DMX32 != 0 {
            732
        } else {
            640
        };
        reference * factor * range
    }

    fn status(&self, now: Ticks) -> u8 {
        let crystal = self.crystal_runs(now);
        let pll_selected = self.registers[C6] & PLLS != 0;
        let internal_reference = self.registers[C1] & IREFS != 0 || !crystal;
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
    pub fn write(&mut self, offset: u32, value: u8, now: Ticks, witness: &mut Witness) {
        let register = offset as usize;
        if register == S || register >= self.registers.len() {
            return;
        }
        let before = self.registers;
        self.registers[register] = value;
        self.judge(&before, now, witness);
        let wants_crystal = self.registers[C2] & EREFS != 0 && self.registers[C1] & IREFS == 0;
        if wants_crystal && self.crystal_at == NEVER {
            self.crystal_at = now + CRYSTAL_START;
            if self.pll_at == NEVER && before[C6] & PLLS != 0 {
                self.pll_at = self.crystal_at + PLL_LOCK;
            }
        }
        let pll = self.registers[C6] & PLLS != 0;
        if pll && before[C6] & PLLS == 0 {
            self.pll_at = now.max(self.crystal_at).saturating_add(PLL_LOCK);
        } else if !pll {
            self.pll_at = NEVER;
        }
    }

    /// Tells the witness what is wrong with the way from the registers `before` to those of now.
    fn judge(&self, before: &[u8; 14], now: Ticks, witness: &mut Witness) {
        let after = &self.registers;
        let mode = |registers: &[u8; 14]| Mode::of(registers[C1], registers[C2], registers[C6]);
        let (from, to) = (mode(before), mode(after));
        if from != to {
            match (from, to) {
                (_, None) => witness.saw(
                    Trap::ClockTransition,
                    format!(
                        "C1 = {:#04x}, C2 = {:#04x} and C6 = {:#04x} name no mode together",
                        after[C1], after[C2], after[C6]
                    ),
                ),
                (Some(from), Some(to)) if !from.neighbours().contains(&to) => witness.saw(
                    Trap::ClockTransition,
                    format!("a change from {from:?} to {to:?} mode"),
                ),
                (_, Some(Mode::Pbe)) if !self.crystal_runs(now) => witness.saw(
                    Trap::ClockTransition,
                    "the PLL was selected before its reference ran: S[OSCINIT0] is 0",
                ),
                (_, Some(Mode::Pee)) if !self.pll_runs(now) => witness.saw(
                    Trap::ClockTransition,
                    "the PLL was made the system clock before it had locked: S[LOCK0] is 0",
                ),
                _ => {}
            }
        }
        let runs =
            |registers: &[u8; 14]| registers[C6] & PLLS != 0 || registers[C5] & PLLCLKEN != 0;
        let dividers = |registers: &[u8; 14]| (registers[C5] & 0x1F, registers[C6] & 0x1F);
        if runs(before) && runs(after) && dividers(before) != dividers(after) {
            witness.saw(
                Trap::PllChanged,
                "PRDIV0 or VDIV0 was changed while the PLL was on",
            );
        }
        let pll_reference = CRYSTAL_HZ / (u32::from(after[C5] & 0x1F) + 1);
        if runs(after) && !runs(before) && !PLL_REFERENCE_HZ.contains(&pll_reference) {
            witness.saw(
                Trap::PllReference,
                format!("the PLL was started with a reference of {pll_reference} Hz"),
            );
        }
        let uses_fll = matches!(to, Some(Mode::Fee | Mode::Fbe));
        if uses_fll && from != to && !FLL_REFERENCE_HZ.contains(&self.fll_reference()) {
            witness.saw(
                Trap::FllReference,
                format!(
                    "the FLL was given a reference of {} Hz",
                    self.fll_reference()
                ),
            );
        }
    }

    /// The FLL's external reference.
    fn fll_reference(&self) -> u32 {
        let divider = usize::from(self.registers[C1] >> 3 & 7);
        if self.registers[C2] >> 4 & 3 == 0 {
            CRYSTAL_HZ >> divider
        } else {
            CRYSTAL_HZ / FLL_DIVIDER[divider]
        }
    }
}

impl Default for ClockGenerator {
    fn default() -> ClockGenerator {
        ClockGenerator::new()
    }
}
