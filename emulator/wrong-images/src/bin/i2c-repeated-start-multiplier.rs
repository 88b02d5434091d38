//! Sends a repeated START with a multiplier of 2.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    start_i2c();
    write(I2C0_F, 0x52u8);
    address_sensor();
    write(I2C0_C1, 0xB4u8);
});
