//! Recurses until the stack reaches the variables.

#![no_std]
#![no_main]

use wrong_images::chip;

/// Takes most of the RAM.
static mut LARGE: [u8; 60_000] = [1; 60_000];

wrong_images::image!({
    chip::write(&raw mut LARGE as u32, 2u8);
    deeper(1_000);
});

#[inline(never)]
fn deeper(levels: u32) -> u32 {
    let frame = core::hint::black_box([levels; 16]);
    if levels == 0 {
        return frame[0];
    }
    deeper(levels - 1) + frame[1]
}
