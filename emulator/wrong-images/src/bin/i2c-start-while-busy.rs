//! Starts again right after STOP.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    start_i2c();
    address_sensor();
    write(I2C0_C1, 0x80u8);
    write(I2C0_C1, 0xB0u8);
});
