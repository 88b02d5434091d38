//! Has an interrupt handler that does not clear its timer's flag.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    write(SIM_SCGC6, 0x4000_0001u32 | 1 << 23);
    write(PIT_MCR, 0u32);
    write(PIT_LDVAL0, 100u32);
    write(PIT_TCTRL0, 3u32);
    // NVIC_ISER2: PIT0 is interrupt 68.
    write(0xE000_E108, 1u32 << 4);
});

#[cortex_m_rt::exception]
unsafe fn DefaultHandler(_number: i16) {}
