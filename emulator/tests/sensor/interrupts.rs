//! Status and pin (RM 4.19 to 4.21; PS table 4: a pulse of 50 µs).

use crate::driver::{Driver, at_rest};

/// 100 Hz, with this INT_PIN_CFG and INT_ENABLE, 1 ms after a sample.
fn sampling(pin: u8, enable: u8) -> Driver {
    let mut driver = Driver::perfect(at_rest());
    driver.write(0x37, pin);
    driver.write(0x38, enable);
    driver.write(0x19, 9);
    driver.write(0x1A, 1);
    driver.read(0x3A);
    driver.wait(0.011);
    driver
}

#[test]
fn data_ready_is_cleared_by_reading_the_status_alone() {
    let mut driver = sampling(0x00, 0x01);
    driver.accel();
    assert_eq!(driver.read(0x3A), 0x01);
    assert_eq!(driver.read(0x3A), 0x00);
    driver.wait(0.010);
    assert_eq!(driver.read(0x3A), 0x01);
}

#[test]
fn or_by_any_read_where_that_is_asked_for() {
    let mut driver = sampling(0x10, 0x01);
    driver.read(0x75);
    assert_eq!(driver.read(0x3A), 0x00);
    driver.wait(0.010);
    assert_eq!(
        driver.read_many(0x3A, 7)[0],
        0x01,
        "a burst that begins with the status"
    );
}

#[test]
fn a_latched_pin_stays_until_the_status_is_cleared() {
    let mut driver = sampling(0x20, 0x01);
    assert!(driver.sensor.interrupt_pin(driver.now));
    driver.wait(0.005);
    assert!(driver.sensor.interrupt_pin(driver.now));
    driver.read(0x3A);
    assert!(!driver.sensor.interrupt_pin(driver.now));
}

#[test]
fn an_unlatched_pin_pulses_for_50_microseconds() {
    let mut driver = sampling(0x00, 0x01);
    assert!(!driver.sensor.interrupt_pin(driver.now), "1 ms later");
    let mut high = 0;
    let mut pulses = 0;
    let mut before = false;
    for _ in 0..10_000 {
        driver.wait_periods(1, 100_000);
        let level = driver.sensor.interrupt_pin(driver.now);
        high += u32::from(level);
        pulses += u32::from(level && !before);
        before = level;
    }
    assert_eq!((pulses, high), (10, 50), "in 100 ms, in steps of 10 µs");
}

#[test]
fn the_pin_can_be_active_low_and_needs_the_enable() {
    let mut driver = sampling(0xA0, 0x01);
    assert!(!driver.sensor.interrupt_pin(driver.now));
    driver.read(0x3A);
    assert!(driver.sensor.interrupt_pin(driver.now));

    let mut driver = sampling(0x20, 0x00);
    assert!(!driver.sensor.interrupt_pin(driver.now));
    assert_eq!(driver.read(0x3A), 0x01, "the status shows it all the same");
}
