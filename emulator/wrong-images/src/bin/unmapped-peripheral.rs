//! Reads from a slot of the bridge that no peripheral is in.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!({
    chip::read::<u32>(0x4001_0000);
});
