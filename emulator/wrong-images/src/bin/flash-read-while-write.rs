//! Erases a sector of the flash that it runs from.

#![no_std]
#![no_main]

use wrong_images::flash::*;

wrong_images::image!({
    load(ERASE_SECTOR, SECTOR);
    launch_from_flash();
});
