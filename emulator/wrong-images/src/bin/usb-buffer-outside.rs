//! Sends from behind the end of the RAM.

#![no_std]
#![no_main]

use wrong_images::usb::{self, Mistake};

wrong_images::image!({
    usb::run(Mistake::BufferOutside);
});
