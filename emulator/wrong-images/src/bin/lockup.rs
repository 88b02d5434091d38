//! Faults with FAULTMASK set, where no handler can run.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!({
    chip::mask_faults();
    chip::undefined_instruction();
});
