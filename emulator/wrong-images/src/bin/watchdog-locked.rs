//! Writes a watchdog register long after it was unlocked.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!({
    pause(2000);
    write(WDOG_TOVALH, 1u16);
});
