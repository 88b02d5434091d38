//! Writes the second refresh word alone.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!(reset: run_watchdog(), main: {
    pause(2000);
    write(WDOG_REFRESH, 0xB480u16);
});
