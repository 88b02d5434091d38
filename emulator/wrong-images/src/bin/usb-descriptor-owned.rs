//! Changes a descriptor after it was given to the controller.

#![no_std]
#![no_main]

use wrong_images::usb::{self, Mistake};

wrong_images::image!({
    usb::run(Mistake::DescriptorOwned);
});
