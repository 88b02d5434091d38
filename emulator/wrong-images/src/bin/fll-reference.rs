//! Divides the crystal by 32 for the FLL: 500 kHz.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    write(OSC_CR, 0x8Au8);
    write(MCG_C2, 0x24u8);
    write(MCG_C1, 0x80u8);
});
