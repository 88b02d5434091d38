//! Puts the buffer descriptor table where no memory is.

#![no_std]
#![no_main]

use wrong_images::usb::{self, Mistake};

wrong_images::image!({
    usb::run(Mistake::TableOutside);
});
