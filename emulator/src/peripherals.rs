//! The chip's peripherals, one small register model a file.
//!
//! A model holds its registers, answers reads and writes at the register's own width, and says when something will
//! happen next. Whatever lies between two peripherals (clocks, pins, interrupts) is [`crate::chip`]'s business.

pub mod ftfl;

pub mod i2c;

pub mod mcg;

pub mod pins;

pub mod pit;

pub mod rcm;

pub mod register_file;

pub mod sim;

pub mod usbotg;

pub mod wdog;
