//! Runs the bus as fast as the core, at 72 MHz.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    write(SIM_CLKDIV1, 0x0002_0000u32);
    use_crystal();
    start_pll(6, 27);
    use_pll();
});
