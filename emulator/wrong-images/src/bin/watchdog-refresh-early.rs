//! Refreshes the watchdog before its window opens.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!(reset: run_watchdog_with_window(), main: {
    pause(2000);
    write(WDOG_REFRESH, 0xA602u16);
    write(WDOG_REFRESH, 0xB480u16);
});
