//! Executes UDF.

#![no_std]
#![no_main]

use wrong_images::chip;

wrong_images::image!(chip::undefined_instruction());
