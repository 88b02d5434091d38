//! The chip's peripherals, one small register model a file.
//!
//! A model holds its registers, answers reads and writes at the register's own width, and says when something will
//! happen next. Whatever lies between two peripherals (clocks, pins, interrupts) is [`crate::chip`]'s business.

pub mod adc;

pub mod clocks;

pub mod crc;

pub mod dac;

pub mod dma;

pub mod dmamux;

pub mod ftfl;

pub mod ftm;

pub mod i2c;

pub mod lptmr;

pub mod mcg;

pub mod mcm;

pub mod pdb;

pub mod pins;

pub mod pit;

pub mod rcm;

pub mod register_file;

pub mod rtc;

pub mod sim;

pub mod smc;

pub mod spi;

pub mod tsi;

pub mod uart;

pub mod usbotg;

pub mod vref;

pub mod wdog;
