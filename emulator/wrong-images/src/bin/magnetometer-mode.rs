//! Takes the magnetometer from one mode to another without power-down.

#![no_std]
#![no_main]

use wrong_images::chip::*;

wrong_images::image!({
    start_i2c();
    wait_for_sensor();
    write_sensor(SENSOR, 0x37, 0x02);
    write_sensor(MAGNETOMETER, 0x0A, 0x12);
    write_sensor(MAGNETOMETER, 0x0A, 0x16);
});
