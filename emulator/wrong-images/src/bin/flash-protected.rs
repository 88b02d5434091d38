//! Erases a sector that is protected.

#![no_std]
#![no_main]

use wrong_images::flash::*;

wrong_images::image!({
    protect();
    load(ERASE_SECTOR, 0x1000);
    launch();
});
