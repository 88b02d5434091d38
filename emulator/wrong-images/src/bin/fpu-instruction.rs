//! Executes VMOV, as a build for a Cortex-M4F does.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!(chip::fpu_instruction());
