//! Refreshes the watchdog before its window opens.

#![no_std]
#![no_main]

use wrong_images::{chip::*, registers::*};

/// Keeps the watchdog on, with a time-out of 100 ms and a window from 50 ms on, by its 1 kHz oscillator.
fn configure() {
    write(WDOG_UNLOCK, 0xC520u16);
    write(WDOG_UNLOCK, 0xD928u16);
    write(WDOG_TOVALH, 0u16);
    write(WDOG_TOVALL, 100u16);
    write(WDOG_PRESC, 0u16);
    write(WDOG_WINH, 0u16);
    write(WDOG_WINL, 50u16);
    write(WDOG_STCTRLH, 0x01D9u16);
}

wrong_images::image!(reset: configure(), main: {
    pause(2000);
    write(WDOG_REFRESH, 0xA602u16);
    write(WDOG_REFRESH, 0xB480u16);
});
