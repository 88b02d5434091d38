//! Writes two bytes of EEPROM without waiting for the first.

#![no_std]
#![no_main]

use wrong_images::{chip::write, flash::*};

wrong_images::image!({
    load_partition();
    launch();
    load_eeprom();
    launch();
    write(0x1400_0000, 1u8);
    write(0x1400_0001, 2u8);
});
