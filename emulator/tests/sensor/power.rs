//! Sleep, standby, start-up times, wake on motion (PS 3.1, 3.2, 6.1; RM 4.34 and 4.35).

use vrduino_emulator::mpu9250::complaint::Complaint;

use crate::driver::{Driver, G, NOTHING, about_x, constant};
use vrduino_emulator::motion::Instant;

fn turning() -> Driver {
    let instant = Instant {
        rate: [1.0; 3],
        force: [G; 3],
        ..NOTHING
    };
    let mut driver = Driver::perfect(constant(instant));
    driver.set_up();
    driver
}

#[test]
fn asleep_it_answers_but_does_not_measure() {
    let mut driver = turning();
    driver.write(0x6B, 0x41);
    driver.read(0x3A);
    driver.wait(1.0);
    assert_eq!(driver.read(0x3A), 0);
    assert_eq!(driver.read(0x75), 0x71);
}

#[test]
fn from_sleep_the_accelerometer_takes_20_ms_and_the_gyroscope_35() {
    let mut driver = turning();
    driver.write(0x6B, 0x41);
    driver.wait(0.1);
    driver.write(0x6B, 0x01);
    driver.wait(0.018);
    assert_eq!(driver.accel()[0], 0);
    driver.wait(0.004);
    assert_eq!(driver.accel()[0], 2048);
    driver.wait(0.010);
    assert_eq!(driver.complaints(), []);
    assert_eq!(driver.gyro()[0], 0, "32 ms");
    assert_eq!(driver.complaints(), [Complaint::GyroNotStarted]);
    driver.wait(0.005);
    assert_eq!(driver.gyro()[0], 939, "37 ms: 57.3 °/s at 16.4");
}

#[test]
fn the_gyroscope_can_be_turned_off_and_on_beside_the_accelerometer() {
    let mut driver = turning();
    driver.write(0x1B, 0x1B); // 32 kHz, so that nothing is missed
    driver.write(0x6C, 0x07);
    driver.wait(0.1);
    assert_eq!(driver.gyro(), [0; 3]);
    driver.write(0x6C, 0x00);
    for _ in 0..100 {
        driver.wait_periods(1, 32_000);
        assert_eq!(driver.accel(), [2048; 3]);
    }
    driver.wait(0.030);
    assert_eq!(driver.gyro()[0], 0, "33 ms");
    driver.wait(0.005);
    assert_eq!(driver.gyro()[0], 939, "38 ms");
}

#[test]
fn in_standby_the_gyroscope_is_back_at_once() {
    let mut driver = turning();
    driver.write(0x6B, 0x11);
    driver.wait(0.1);
    assert_eq!(driver.gyro(), [0; 3]);
    assert_eq!(driver.accel()[0], 2048);
    driver.write(0x6B, 0x01);
    driver.wait(0.002);
    assert_eq!(driver.gyro()[0], 939);
    assert_eq!(driver.complaints(), []);
}

/// The sequence of PS 6.1, figure 3: only a change between samples beyond the threshold counts.
#[test]
fn motion_wakes() {
    let jump = |size: f64| about_x(move |t| if t < 1.0 { 0.2 } else { 0.2 + size });
    // Thresholds of 32 mg, and of half a g, which is 8192 counts exactly and has to be exceeded.
    for (threshold, size, wakes) in [
        (8, 0.030, false),
        (8, 0.034, true),
        (8, -0.034, true),
        (125, 0.5, false),
        (125, 0.5001, true),
    ] {
        let mut driver = Driver::perfect(jump(size));
        driver.write(0x6B, 0x01);
        driver.write(0x6C, 0x07);
        driver.write(0x1D, 0x01);
        driver.write(0x38, 0x40);
        driver.write(0x69, 0xC0);
        driver.write(0x1F, threshold);
        driver.write(0x1E, 6); // 15.63 Hz
        driver.write(0x37, 0x20);
        driver.write(0x6B, 0x21);
        driver.wait(0.3);
        driver.read(0x3A);
        driver.wait(0.55);
        assert_eq!(driver.read(0x3A) & 0x40, 0, "still at {size} g");
        assert!(!driver.sensor.interrupt_pin(driver.now));
        driver.wait(0.2);
        assert_eq!(driver.sensor.interrupt_pin(driver.now), wakes, "{size} g");
        assert_eq!(driver.read(0x3A) & 0x40 != 0, wakes, "{size} g");
    }
}

#[test]
fn a_reserved_rate_of_the_low_power_accelerometer_is_complained_about() {
    let mut driver = turning();
    driver.write(0x1E, 12);
    assert_eq!(driver.complaints(), [Complaint::ReservedAccelRate(12)]);
}
