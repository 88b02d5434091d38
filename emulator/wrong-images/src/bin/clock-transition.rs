//! Goes from the FLL straight to the PLL.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!(write(MCG_C6, 0x40u8));
