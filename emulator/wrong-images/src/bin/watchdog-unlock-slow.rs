//! Lets too much time pass between the two unlock words.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

wrong_images::image!(
    reset: {
        write(WDOG_UNLOCK, 0xC520u16);
        pause(200);
        write(WDOG_UNLOCK, 0xD928u16);
    },
    main: ()
);
