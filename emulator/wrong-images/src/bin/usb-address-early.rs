//! Takes its address before the host has its answer.

#![no_std]
#![no_main]

use wrong_images::usb::{self, Mistake};

wrong_images::image!({
    usb::run(Mistake::AddressEarly);
});
