//! Does nothing wrong: the device that the other `usb-` images make their mistakes on.

#![no_std]
#![no_main]

use wrong_images::usb::{self, Mistake};

wrong_images::image!({
    usb::run(Mistake::None);
});
