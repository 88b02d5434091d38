//! Lets too much time pass between the two refresh words.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

/// Keeps the watchdog on, with a time-out of 100 ms of its 1 kHz oscillator.
fn configure() {
    write(WDOG_UNLOCK, 0xC520u16);
    write(WDOG_UNLOCK, 0xD928u16);
    write(WDOG_TOVALH, 0u16);
    write(WDOG_TOVALL, 100u16);
    write(WDOG_PRESC, 0u16);
    write(WDOG_STCTRLH, 0x01D1u16);
}

wrong_images::image!(reset: configure(), main: {
    pause(2000);
    write(WDOG_REFRESH, 0xA602u16);
    pause(200);
    write(WDOG_REFRESH, 0xB480u16);
});
