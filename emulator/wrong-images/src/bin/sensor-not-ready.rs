//! Resets the sensor and goes on at once.

#![no_std]
#![no_main]

use wrong_images::chip::*;

wrong_images::image!({
    start_i2c();
    wait_for_sensor();
    write_sensor(SENSOR, 0x6B, 0x80);
    write_sensor(SENSOR, 0x6B, 0x01);
});
