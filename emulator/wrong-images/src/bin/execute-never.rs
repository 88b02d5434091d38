//! Jumps to a register.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!(chip::call(0x4004_8001));
