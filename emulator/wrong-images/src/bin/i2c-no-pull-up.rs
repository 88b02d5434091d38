//! Starts a transfer on the pair of pins without pull-ups.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    start_i2c();
    write(PORTB_PCR2, 0u32);
    write(PORTB_PCR3, 0u32);
    write(PORTB_PCR0, 0x0000_0200u32);
    write(PORTB_PCR1, 0x0000_0200u32);
    address_sensor();
});
