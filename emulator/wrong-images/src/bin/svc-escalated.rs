//! Executes SVC with interrupts masked.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!({
    chip::mask_interrupts();
    chip::supervisor_call();
});
