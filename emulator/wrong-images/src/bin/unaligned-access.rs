//! Loads two words from an address that is not aligned.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!(chip::load_two_words(0x1FFF_9002));
