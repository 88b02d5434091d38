//! Drives SCL at 1 MHz.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    start_i2c();
    write(I2C0_F, 0x00u8);
    address_sensor();
});
