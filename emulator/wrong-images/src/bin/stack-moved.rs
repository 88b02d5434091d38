//! Nothing wrong: a main stack in the middle of the variables, as systems with several stacks have it.

#![no_std]
#![no_main]

use wrong_images::chip;

/// Room for the stack, and variables above it.
static mut LARGE: [u8; 8_000] = [1; 8_000];

wrong_images::image!({
    let stack = &raw mut LARGE as u32 + 4_000;
    chip::write(stack, 2u8);
    chip::use_stack(stack & !7);
});
