//! Programs the same longword twice.

#![no_std]
#![no_main]

use wrong_images::flash::*;

wrong_images::image!({
    load(PROGRAM_LONGWORD, SECTOR);
    launch();
    launch();
});
