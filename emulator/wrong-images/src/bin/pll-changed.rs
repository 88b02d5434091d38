//! Changes the multiplier of a PLL that runs.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    use_crystal();
    start_pll(8, 24);
    write(MCG_C6, 0x40u8 | 1);
});
