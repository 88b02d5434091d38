//! Launches a command over the error flags of the last one.

#![no_std]
#![no_main]

use wrong_images::flash::*;

wrong_images::image!({
    load(0x77, SECTOR);
    launch();
    load(ERASE_SECTOR, SECTOR);
    launch();
});
