//! Writes an 8-bit register of I2C0 as a word.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    start_i2c();
    write(I2C0_A1, 0x12u32);
});
