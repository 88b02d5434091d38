//! Writes a byte without a START.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    start_i2c();
    write(I2C0_D, 0xD0u8);
});
