//! Writes behind the end of the RAM.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!(chip::write(0x2000_8000, 0u32));
