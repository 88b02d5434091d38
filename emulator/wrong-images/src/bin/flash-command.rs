//! Launches a command that does not exist.

#![no_std]
#![no_main]

use wrong_images::flash::*;

wrong_images::image!({
    load(0x77, SECTOR);
    launch();
});
