//! Runs the core at 96 MHz.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    write(SIM_CLKDIV1, 0x0113_0000u32);
    use_crystal();
    start_pll(4, 24);
    use_pll();
});
