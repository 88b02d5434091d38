//! Leaves DMA on for the last byte it reads.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    start_i2c();
    write(I2C0_C1, 0xB0u8);
    write(I2C0_D, 0xD1u8);
    end_of_byte();
    write(I2C0_C1, 0xA8u8);
    read::<u8>(I2C0_D);
    write(I2C0_C1, 0xE9u8);
});
