//! The FIFO (PS 4.17; RM 4.11, 4.33, 4.36, 4.37).

use vrduino_emulator::motion::Instant;
use vrduino_emulator::mpu9250::complaint::Complaint;

use crate::driver::{Driver, G, NOTHING, about_x, big_endian, constant};

const ACCEL: u8 = 0x08;
const TEMPERATURE: u8 = 0x80;
const GYRO_X: u8 = 0x40;
const GYRO: u8 = 0x70;

/// A driver with a FIFO that takes `enable` at 1 kHz from now on.
fn filling(mut driver: Driver, enable: u8) -> Driver {
    driver.set_up();
    driver.write(0x6A, 0x44);
    driver.write(0x23, enable);
    driver
}

fn still() -> Driver {
    Driver::perfect(constant(Instant {
        rate: [0.1, 0.2, -0.3],
        force: [0.5 * G, -G, 1.5 * G],
        ..NOTHING
    }))
}

#[test]
fn a_sample_is_stored_in_the_order_of_the_registers() {
    let mut driver = filling(still(), ACCEL | TEMPERATURE | GYRO);
    driver.wait_periods(3, 1_000);
    assert_eq!(driver.fifo_count(), 3 * 14);
    let bytes = driver.read_many(0x74, 14);
    let mut expected = vec![1024, -2048, 3072, 1335];
    expected.extend(driver.gyro());
    assert_eq!(big_endian(&bytes), expected);
    assert_eq!(driver.fifo_count(), 2 * 14);
}

#[test]
fn each_enable_adds_its_own_bytes() {
    for (enable, bytes) in [
        (0x00, 0),
        (GYRO_X, 2),
        (0x20, 2),
        (0x10, 2),
        (GYRO, 6),
        (ACCEL, 6),
        (TEMPERATURE, 2),
        (0xF8, 14),
    ] {
        let mut driver = filling(still(), enable);
        driver.wait_periods(10, 1_000);
        assert_eq!(driver.fifo_count(), 10 * bytes, "{enable:#04x}");
    }
}

#[test]
fn the_axes_of_the_gyroscope_are_enabled_one_by_one() {
    for (enable, axis) in [(0x40, 0), (0x20, 1), (0x10, 2)] {
        let mut driver = filling(still(), enable);
        driver.wait_periods(1, 1_000);
        let bytes = driver.read_many(0x74, 2);
        assert_eq!(big_endian(&bytes)[0], driver.gyro()[axis]);
    }
}

#[test]
fn the_count_is_held_from_its_high_byte_on() {
    let mut driver = filling(still(), ACCEL);
    driver.wait_periods(50, 1_000);
    assert_eq!(driver.read(0x72), 1);
    driver.wait_periods(10, 1_000);
    assert_eq!(driver.read(0x73), 44, "300 less 256, as of the high byte");
    assert_eq!(driver.fifo_count(), 360);
}

/// RM 4.5 and 4.37: the oldest bytes give way, and as 512 is no multiple of 6, the rest begins inside a sample.
#[test]
fn a_full_fifo_loses_its_oldest_bytes() {
    let mut driver = filling(Driver::perfect(about_x(|t| (t - 0.2) * 10.0)), ACCEL);
    driver.read(0x3A);
    driver.wait_periods(85, 1_000);
    assert_eq!(driver.fifo_count(), 510);
    assert_eq!(driver.read(0x3A) & 0x10, 0);
    driver.wait_periods(15, 1_000);
    assert_eq!(driver.read(0x3A) & 0x10, 0x10, "overflow");
    assert_eq!(driver.read(0x3A) & 0x10, 0, "read and cleared");
    assert_eq!(driver.fifo_count(), 512);
    let bytes = driver.read_many(0x74, 512);
    let last: Vec<i16> = big_endian(&bytes[506..]);
    assert_eq!(last[0], driver.accel()[0], "the newest sample is whole");
    // 600 bytes went in, 88 are lost: four bytes of the fifteenth sample.
    let second = big_endian(&bytes[2..4])[0];
    let newest = last[0];
    let steps = f64::from(newest - second) / (10.0 * 2.048);
    assert!((steps - 84.0).abs() < 0.2, "{steps} samples between");
}

#[test]
fn with_fifo_mode_a_full_fifo_keeps_its_oldest_bytes() {
    let mut driver = Driver::perfect(about_x(|t| (t - 0.2) * 10.0));
    driver.set_up();
    driver.write(0x1A, 0x41);
    driver.write(0x6A, 0x44);
    driver.write(0x23, ACCEL);
    driver.wait_periods(1, 1_000);
    let first = driver.accel()[0];
    driver.wait_periods(99, 1_000);
    assert_eq!(driver.read(0x3A) & 0x10, 0x10);
    assert_eq!(driver.fifo_count(), 512);
    let bytes = driver.read_many(0x74, 512);
    assert_eq!(big_endian(&bytes)[0], first);
}

#[test]
fn an_empty_fifo_repeats_the_last_byte() {
    let mut driver = filling(still(), GYRO_X);
    driver.wait_periods(1, 1_000);
    driver.write(0x23, 0);
    let bytes = driver.read_many(0x74, 2);
    assert_eq!(driver.complaints(), []);
    assert_eq!(driver.read_many(0x74, 3), [bytes[1]; 3]);
    assert_eq!(driver.complaints(), [Complaint::FifoEmpty]);
}

#[test]
fn reset_empties_it_and_disabling_stops_it() {
    let mut driver = filling(still(), ACCEL);
    driver.wait_periods(10, 1_000);
    driver.write(0x6A, 0x44);
    assert_eq!(driver.fifo_count(), 0);
    assert_eq!(driver.read(0x6A), 0x40, "FIFO_RST clears itself");
    driver.wait_periods(2, 1_000);
    assert_eq!(driver.fifo_count(), 12);
    driver.write(0x6A, 0x00);
    driver.wait_periods(5, 1_000);
    assert_eq!(driver.fifo_count(), 12);
    driver.read(0x74);
    assert_eq!(driver.complaints(), [Complaint::FifoDisabled]);
}

#[test]
fn bytes_can_be_written_to_it() {
    let mut driver = filling(still(), 0);
    driver.write(0x74, 0xA5);
    driver.write(0x74, 0x5A);
    assert_eq!(driver.fifo_count(), 2);
    assert_eq!(driver.read_many(0x74, 2), [0xA5, 0x5A]);
}

#[test]
fn it_fills_while_it_is_read() {
    use vrduino_emulator::peripherals::i2c::Target;
    let mut driver = filling(still(), ACCEL);
    driver.wait_periods(2, 1_000);
    let now = driver.now;
    assert!(driver.sensor.address(0xD0, now) && driver.sensor.write(0x74, now));
    assert!(driver.sensor.address(0xD1, now));
    for byte in 0..24 {
        // 24 bytes in 6 ms; two samples were there before.
        driver.sensor.read(now + byte * 36_000);
    }
    assert_eq!(driver.complaints(), []);
}
