//! Starts a transfer with the pins still disconnected.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    start_i2c();
    write(PORTB_PCR2, 0u32);
    write(PORTB_PCR3, 0u32);
    address_sensor();
});
