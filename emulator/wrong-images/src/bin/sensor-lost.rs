//! Disables the sensor's I2C interface.

#![no_std]
#![no_main]

use wrong_images::chip::*;

wrong_images::image!({
    start_i2c();
    wait_for_sensor();
    write_sensor(SENSOR, 0x6A, 0x10);
});
