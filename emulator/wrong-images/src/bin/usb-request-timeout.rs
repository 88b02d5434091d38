//! Never answers SET_CONFIGURATION.

#![no_std]
#![no_main]

use wrong_images::usb::{self, Mistake};

wrong_images::image!({
    usb::run(Mistake::RequestTimeout);
});
