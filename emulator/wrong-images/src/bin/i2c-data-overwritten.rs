//! Writes the next byte before the last has gone.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    start_i2c();
    address_sensor();
    write(I2C0_D, 0x6Bu8);
    write(I2C0_D, 0x00u8);
});
