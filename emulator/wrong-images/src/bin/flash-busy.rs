//! Launches a command while another one runs.

#![no_std]
#![no_main]

use wrong_images::flash::*;

wrong_images::image!({
    load(ERASE_SECTOR, SECTOR);
    launch_twice();
});
