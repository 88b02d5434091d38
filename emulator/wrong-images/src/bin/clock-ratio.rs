//! Divides the clock by 2 for the core and by 3 for the bus.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!(write(SIM_CLKDIV1, 0x1235_0000u32));
