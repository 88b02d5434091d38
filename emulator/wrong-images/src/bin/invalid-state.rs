//! Calls a function by an even address.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!(chip::call(0x0000_0800));
