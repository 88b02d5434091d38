//! Erases the sector with the flash configuration field.

#![no_std]
#![no_main]

use wrong_images::flash::*;

wrong_images::image!({
    load(ERASE_SECTOR, 0x0000);
    launch();
});
