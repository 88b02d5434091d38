//! Reads a word that lies in both halves of the RAM.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!({
    chip::read::<Unaligned>(0x1FFF_FFFE);
});

/// Two bytes below the boundary and two above.
#[repr(C, packed)]
struct Unaligned(u32);
