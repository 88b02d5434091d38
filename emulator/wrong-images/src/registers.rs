//! Addresses of registers (K20 manual, chapter 4 and the memory map of each module).

#![allow(missing_docs)] // The names are the manual's.

pub const SIM_SCGC4: u32 = 0x4004_8034;
pub const SIM_SCGC5: u32 = 0x4004_8038;
pub const SIM_SCGC6: u32 = 0x4004_803C;
pub const SIM_SOPT2: u32 = 0x4004_8004;
pub const SIM_CLKDIV1: u32 = 0x4004_8044;
pub const SIM_CLKDIV2: u32 = 0x4004_8048;

pub const WDOG_STCTRLH: u32 = 0x4005_2000;
pub const WDOG_TOVALH: u32 = 0x4005_2004;
pub const WDOG_TOVALL: u32 = 0x4005_2006;
pub const WDOG_WINH: u32 = 0x4005_2008;
pub const WDOG_WINL: u32 = 0x4005_200A;
pub const WDOG_REFRESH: u32 = 0x4005_200C;
pub const WDOG_UNLOCK: u32 = 0x4005_200E;
pub const WDOG_PRESC: u32 = 0x4005_2016;

pub const MCG_C1: u32 = 0x4006_4000;
pub const MCG_C2: u32 = 0x4006_4001;
pub const MCG_C5: u32 = 0x4006_4004;
pub const MCG_C6: u32 = 0x4006_4005;
pub const MCG_S: u32 = 0x4006_4006;
pub const OSC_CR: u32 = 0x4006_5000;

pub const PORTB_PCR0: u32 = 0x4004_A000;
pub const PORTB_PCR1: u32 = 0x4004_A004;
pub const PORTB_PCR2: u32 = 0x4004_A008;
pub const PORTB_PCR3: u32 = 0x4004_A00C;

pub const I2C0_A1: u32 = 0x4006_6000;
pub const I2C0_F: u32 = 0x4006_6001;
pub const I2C0_C1: u32 = 0x4006_6002;
pub const I2C0_S: u32 = 0x4006_6003;
pub const I2C0_D: u32 = 0x4006_6004;

pub const PIT_MCR: u32 = 0x4003_7000;
pub const PIT_LDVAL0: u32 = 0x4003_7100;
pub const PIT_TCTRL0: u32 = 0x4003_7108;

pub const ADC0_SC1A: u32 = 0x4003_B000;

pub const USB0_ISTAT: u32 = 0x4007_2080;
pub const USB0_STAT: u32 = 0x4007_2090;
pub const USB0_CTL: u32 = 0x4007_2094;
pub const USB0_ADDR: u32 = 0x4007_2098;
pub const USB0_BDTPAGE1: u32 = 0x4007_209C;
pub const USB0_BDTPAGE2: u32 = 0x4007_20B0;
pub const USB0_BDTPAGE3: u32 = 0x4007_20B4;
pub const USB0_ENDPT0: u32 = 0x4007_20C0;
pub const USB0_ENDPT1: u32 = 0x4007_20C4;
pub const USB0_ENDPT2: u32 = 0x4007_20C8;
pub const USB0_ENDPT3: u32 = 0x4007_20CC;
pub const USB0_USBCTRL: u32 = 0x4007_2100;
pub const USB0_CONTROL: u32 = 0x4007_2108;
