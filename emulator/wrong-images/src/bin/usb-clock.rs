//! Attaches to the USB bus with the FLL's clock.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    write(SIM_SCGC4, 0xF010_0030u32 | 1 << 18);
    write(USB0_USBCTRL, 0u8);
    write(USB0_CTL, 1u8);
    write(USB0_CONTROL, 0x10u8);
});
