//! Writes to a constant.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!(chip::write(0x0000_1000, 1u32));
