//! Reads the FIFO without having enabled it.

#![no_std]
#![no_main]

use wrong_images::chip::*;

wrong_images::image!({
    start_i2c();
    wait_for_sensor();
    read_sensor(SENSOR, 0x74);
});
