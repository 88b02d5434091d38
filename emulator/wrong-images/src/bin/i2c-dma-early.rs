//! Switches DMA on over the end of the address.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    start_i2c();
    write(I2C0_C1, 0xB0u8);
    write(I2C0_D, 0xD1u8);
    wait(I2C0_S, 0x02, 0x02);
    write(I2C0_C1, 0xE1u8);
});
