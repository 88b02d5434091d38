//! Gives the PLL the undivided crystal.

#![no_std]
#![no_main]

use wrong_images::chip::*;

wrong_images::image!({
    use_crystal();
    start_pll(1, 24);
});
