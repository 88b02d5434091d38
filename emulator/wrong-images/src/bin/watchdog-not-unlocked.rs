//! Leaves the watchdog as it is after reset.

#![no_std]
#![no_main]

wrong_images::image!(reset: (), main: ());
