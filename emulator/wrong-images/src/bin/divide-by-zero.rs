//! Divides by zero with CCR.DIV_0_TRP set.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!({
    chip::write(0xE000_ED14, 0x0000_0210u32);
    chip::divide(1, 0);
});
