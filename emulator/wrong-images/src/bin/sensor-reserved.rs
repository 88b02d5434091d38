//! Writes to a register that the sensor's map does not name.

#![no_std]
#![no_main]

use wrong_images::chip::*;

wrong_images::image!({
    start_i2c();
    wait_for_sensor();
    write_sensor(SENSOR, 0x10, 1);
});
