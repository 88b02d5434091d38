//! Takes a fault with the stack pointer below the RAM.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!(chip::svc_with_stack(0x1FFF_0000));
