//! A VRduino board in software: boots the very image that is flashed.
//!
//! ```text
//! motion ──► MPU-9250 ──I2C──► chip ◄──► processor ◄── image
//!                                │
//!                               USB
//!                                │
//!                               host ──► lines
//! ```
//!
//! The models are made from the manuals (K20 Sub-Family Reference Manual, MPU-9250 Product Specification and Register
//! Map, USB 2.0) and share no code with the firmware, so that a mistake cannot hide by being made twice.
//! Modules in the order of the path of a sample:

pub mod motion;

pub mod mpu9250;

pub mod peripherals;

pub mod chip;

pub mod cpu;

pub mod usb_transaction;

pub mod host;

pub mod board;

pub mod usbip;

pub mod image;

pub mod firmware;

pub mod random;

pub mod witness;

pub mod hash;

pub mod journal;

pub mod trace;

pub mod vcd;

pub mod gdb;

pub mod time;
