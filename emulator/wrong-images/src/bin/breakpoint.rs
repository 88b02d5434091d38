//! Executes BKPT with no debugger there.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!(chip::breakpoint());
