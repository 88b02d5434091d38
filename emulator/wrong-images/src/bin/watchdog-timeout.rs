//! Never refreshes the watchdog.

#![no_std]
#![no_main]

use wrong_images::chip::*;

wrong_images::image!(reset: run_watchdog(), main: ());
