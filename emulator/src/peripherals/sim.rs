//! System integration module (K20 manual, chapter 12): clock gates, dividers, unique identification.

use std::collections::BTreeMap;

const SOPT2: u32 = 0x1004;
const SDID: u32 = 0x1024;
const CLKDIV1: u32 = 0x1044;
const CLKDIV2: u32 = 0x1048;
const SCGC1: u32 = 0x1028;
const FCFG1: u32 = 0x104C;
const UIDML: u32 = 0x105C;
const UIDL: u32 = 0x1060;

/// SIM's registers; offsets count from 0x4004_7000.
#[derive(Debug, Clone)]
pub struct SystemIntegration {
    registers: BTreeMap<u32, u32>,
}

impl SystemIntegration {
    /// The state after reset.
    pub fn new() -> SystemIntegration {
        let reset = [
            (0x0000, 0x8000_9000),  // SOPT1
            (SDID, 0x0000_014D),    // K20, 64 pins
            (0x1034, 0xF010_0030),  // SCGC4
            (0x1038, 0x0004_0182),  // SCGC5
            (0x103C, 0x4000_0001),  // SCGC6: RTC, flash
            (0x1040, 0x0000_0002),  // SCGC7: DMA
            (CLKDIV1, 0x0001_0000), // FOPT.LPBOOT = 1: core /1, bus /1, flash /2
            (FCFG1, 0xFF0F_0F00),   // 256 KiB program flash, FlexNVM not partitioned
            (0x1050, 0x2F90_0000),  // FCFG2
            (UIDML, 0x5652_4455),
            (UIDL, 0x4923_0001),
        ];
        SystemIntegration {
            registers: reset.into(),
        }
    }

    /// Loads EESIZE and DEPART of FCFG1, which happens during reset.
    pub fn set_partition(&mut self, fields: u32) {
        let register = self.register(FCFG1) & !0x000F_0F00 | fields;
        self.registers.insert(FCFG1, register);
    }

    fn register(&self, offset: u32) -> u32 {
        self.registers.get(&offset).copied().unwrap_or(0)
    }

    /// Whether clock gate `bit` of SCGC`n` is open.
    pub fn gate(&self, n: u32, bit: u32) -> bool {
        self.register(SCGC1 + 4 * (n - 1)) >> bit & 1 != 0
    }

    /// Core, bus and flash clock for an MCG output of `hz`.
    pub fn divide(&self, hz: u32) -> (u32, u32, u32) {
        let dividers = self.register(CLKDIV1);
        let divided = |shift: u32| hz / ((dividers >> shift & 0xF) + 1);
        (divided(28), divided(24), divided(16))
    }

    /// Whether bus and flash clock are whole divisions of the core clock, the flash clock by 8 at most and not above the
    /// bus clock (K20 manual, clock definitions).
    pub fn ratios_are_whole(&self) -> bool {
        let dividers = self.register(CLKDIV1);
        let divider = |shift: u32| (dividers >> shift & 0xF) + 1;
        let (core, bus, flash) = (divider(28), divider(24), divider(16));
        bus.is_multiple_of(core) && flash.is_multiple_of(core) && flash >= bus && flash / core <= 8
    }

    /// The USB clock made from the PLL, if SOPT2 selects the PLL for it.
    pub fn usb_hz(&self, pll_hz: Option<u32>) -> Option<u32> {
        let options = self.register(SOPT2);
        let divider = self.register(CLKDIV2);
        let (fraction, division) = ((divider & 1) + 1, (divider >> 1 & 7) + 1);
        (options >> 16 & 1 != 0 && options >> 18 & 1 != 0).then_some(pll_hz? * fraction / division)
    }

    /// Reads a 32-bit register.
    pub fn read(&self, offset: u32) -> u32 {
        self.register(offset)
    }

    /// Writes a 32-bit register; identification registers are read-only.
    pub fn write(&mut self, offset: u32, value: u32) {
        if offset != SDID && !(0x104C..=UIDL).contains(&offset) {
            self.registers.insert(offset, value);
        }
    }
}

impl Default for SystemIntegration {
    fn default() -> SystemIntegration {
        SystemIntegration::new()
    }
}
