//! Gives one buffer to two descriptors.

#![no_std]
#![no_main]

use wrong_images::usb::{self, Mistake};

wrong_images::image!({
    usb::run(Mistake::BufferTwice);
});
