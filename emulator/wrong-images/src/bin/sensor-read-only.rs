//! Writes to WHO_AM_I.

#![no_std]
#![no_main]

use wrong_images::chip::*;

wrong_images::image!({
    start_i2c();
    wait_for_sensor();
    write_sensor(SENSOR, 0x75, 0x71);
});
