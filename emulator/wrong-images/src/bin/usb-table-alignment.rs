//! Puts the buffer descriptor table at half of its alignment.

#![no_std]
#![no_main]

use wrong_images::usb::{self, Mistake};

wrong_images::image!({
    usb::run(Mistake::TableAlignment);
});
