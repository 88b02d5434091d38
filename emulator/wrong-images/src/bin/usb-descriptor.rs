//! Describes a bulk endpoint that full speed does not have.

#![no_std]
#![no_main]

use wrong_images::usb::{self, Mistake};

wrong_images::image!({
    usb::run(Mistake::Descriptor);
});
