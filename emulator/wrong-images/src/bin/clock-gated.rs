//! Reads a register of the ADC, whose clock is off.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    read::<u32>(ADC0_SC1A);
});
