//! Lets too much time pass between the two refresh words.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!(reset: run_watchdog(), main: {
    pause(2000);
    write(WDOG_REFRESH, 0xA602u16);
    pause(200);
    write(WDOG_REFRESH, 0xB480u16);
});
