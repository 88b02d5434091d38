//! Reads the magnetometer's data again and again, but never ST2.

#![no_std]
#![no_main]

use wrong_images::chip::*;

wrong_images::image!({
    start_i2c();
    wait_for_sensor();
    write_sensor(SENSOR, 0x37, 0x02);
    write_sensor(MAGNETOMETER, 0x0A, 0x16);
    for _ in 0..100 {
        pause(200_000);
        read_sensor(MAGNETOMETER, 0x03);
    }
});
