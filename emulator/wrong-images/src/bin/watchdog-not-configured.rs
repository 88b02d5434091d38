//! Unlocks the watchdog and leaves it at that.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!(
    reset: {
        write(WDOG_UNLOCK, 0xC520u16);
        write(WDOG_UNLOCK, 0xD928u16);
    },
    main: ()
);
