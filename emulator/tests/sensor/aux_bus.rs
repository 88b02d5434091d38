//! The auxiliary master with the magnetometer as its slave (RM 4.12 to 4.18, 4.25 to 4.30).

use vrduino_emulator::mpu9250::Part;
use vrduino_emulator::mpu9250::complaint::Complaint;

use crate::driver::{AK, Driver, in_field, little_endian};

/// ADDR of a read.
const READ_AK: u8 = AK | 0x80;

/// The master on, at 400 kHz and 1 kHz samples.
fn master() -> Driver {
    master_of(Part::perfect())
}

fn master_of(part: Part) -> Driver {
    let mut driver = Driver::new(in_field([30.0, 15.0, 45.0]), part);
    driver.set_up();
    driver.write(0x24, 0x0D);
    driver.write(0x6A, 0x20);
    driver
}

/// Slave 4: one byte written to the magnetometer.
fn write_through(driver: &mut Driver, register: u8, value: u8) {
    driver.write(0x31, AK);
    driver.write(0x32, register);
    driver.write(0x33, value);
    driver.write(0x34, 0x80);
    driver.wait(0.003);
    assert_eq!(driver.read(0x34) & 0x80, 0, "it clears itself");
}

#[test]
fn slave_4_reads_and_writes_single_bytes() {
    let mut driver = master();
    write_through(&mut driver, 0x0A, 0x16);
    assert_eq!(driver.read(0x36), 0x40, "SLV4_DONE");
    assert_eq!(driver.read(0x36), 0x00, "read and cleared");
    for (register, value) in [(0x00, 0x48), (0x0A, 0x16)] {
        driver.write(0x31, READ_AK);
        driver.write(0x32, register);
        driver.write(0x34, 0x80);
        driver.wait(0.003);
        assert_eq!(driver.read(0x35), value);
    }
}

/// The usual way to a nine-axis sample: ST1 to ST2 by slave 0, behind the sensor's own registers.
#[test]
fn slave_0_brings_the_field_beside_the_other_sensors() {
    let mut driver = master();
    write_through(&mut driver, 0x0A, 0x16);
    driver.write(0x25, READ_AK);
    driver.write(0x26, 0x03);
    driver.write(0x27, 0x87);
    driver.wait(0.050);
    let bytes = driver.read_many(0x3B, 21);
    assert_eq!(little_endian(&bytes[14..20]), [100, 200, -300]);
    assert_eq!(bytes[20], 0x10, "ST2");
    assert_eq!(driver.complaints(), []);
}

#[test]
fn slaves_share_the_external_registers_in_order() {
    let mut driver = master();
    for (base, register, length) in [(0x25, 0x00, 2), (0x28, 0x0A, 1), (0x2B, 0x00, 1)] {
        driver.write(base, READ_AK);
        driver.write(base + 1, register);
        driver.write(base + 2, 0x80 | length);
    }
    driver.wait(0.005);
    assert_eq!(driver.read_many(0x49, 5), [0x48, 0x9A, 0x00, 0x48, 0x00]);
    // A disabled slave keeps its place ...
    driver.write(0x27, 0x02);
    driver.write(0x29, 0x00);
    driver.wait(0.005);
    assert_eq!(driver.read_many(0x49, 5), [0x48, 0x9A, 0x48, 0x48, 0x00]);
    // ... until all are disabled.
    driver.write(0x2A, 0x00);
    driver.write(0x2D, 0x00);
    driver.write(0x29, 0x0A);
    driver.write(0x2A, 0x81);
    driver.wait(0.005);
    assert_eq!(driver.read(0x49), 0x00);
}

#[test]
fn bytes_of_a_word_can_be_swapped() {
    // RM 4.13: four bytes from register 1 with words at even registers: the first and the last stay.
    for (register, control, order) in [
        (0x01, 0xC4, [1, 3, 2, 4]),
        (0x02, 0xC4, [3, 2, 5, 4]),
        (0x01, 0xD4, [2, 1, 4, 3]),
        (0x01, 0x84, [1, 2, 3, 4]),
    ] {
        let mut driver = master();
        write_through(&mut driver, 0x0A, 0x11);
        driver.wait(0.01);
        driver.write(0x25, READ_AK);
        driver.write(0x26, register);
        driver.write(0x27, 0x84);
        driver.wait(0.005);
        let plain = |register: u8| -> u8 {
            match register {
                1 => 0x9A,
                // Field 100, 200, -300 in single mode: data stays as it is.
                3 => 100,
                5 => 200,
                _ => 0,
            }
        };
        driver.write(0x27, control);
        driver.wait(0.005);
        let expected = order.map(plain);
        assert_eq!(
            driver.read_many(0x49, 4),
            expected,
            "{register} {control:#04x}"
        );
    }
}

#[test]
fn who_does_not_answer_shows_in_the_status() {
    let mut driver = master_of(Part::perfect().without_magnetometer());
    for base in [0x25, 0x28, 0x2B, 0x2E] {
        driver.write(base, READ_AK);
        driver.write(base + 2, 0x81);
    }
    driver.write(0x31, READ_AK);
    driver.write(0x34, 0x80);
    driver.wait(0.005);
    assert_eq!(driver.read(0x36), 0x40 | 0x1F);
}

/// Slaves with a delay are served every (1 + I2C_MST_DLY)th sample.
#[test]
fn slaves_can_be_served_less_often() {
    let mut driver = master();
    write_through(&mut driver, 0x0A, 0x16);
    driver.write(0x34, 9);
    driver.write(0x67, 0x01);
    driver.write(0x25, READ_AK);
    driver.write(0x26, 0x02);
    driver.write(0x27, 0x88);
    driver.wait(0.1);
    let mut fresh = 0;
    for _ in 0..1_000 {
        driver.wait_periods(1, 1_000);
        fresh += u32::from(driver.read(0x49) & 1);
    }
    // ST1 shows a new measurement for the ten samples until the next access, and each access finds one.
    assert!(fresh >= 990, "{fresh}");
    driver.write(0x67, 0x00);
    driver.wait(0.1);
    let mut fresh = 0;
    for _ in 0..1_000 {
        driver.wait_periods(1, 1_000);
        fresh += u32::from(driver.read(0x49) & 1);
    }
    assert!(
        (95..=105).contains(&fresh),
        "{fresh} of 1000 are new at 100 Hz"
    );
}

#[test]
fn external_data_goes_to_the_fifo_behind_the_rest() {
    let mut driver = master();
    driver.write(0x25, READ_AK);
    driver.write(0x26, 0x00);
    driver.write(0x27, 0x82);
    driver.wait(0.005);
    driver.write(0x6A, 0x64);
    driver.write(0x23, 0x81);
    driver.wait_periods(2, 1_000);
    assert_eq!(driver.fifo_count(), 2 * 4);
    let bytes = driver.read_many(0x74, 4);
    assert_eq!(bytes[2..], [0x48, 0x9A]);
}

/// Seven bytes at 400 kHz take 0.2 ms (RM 4.12: WAIT_FOR_ES).
#[test]
fn data_ready_can_wait_for_the_external_data() {
    for (wait, earliest) in [(0x00, 0), (0x40, 200)] {
        let mut driver = master();
        driver.write(0x24, 0x0D | wait);
        driver.write(0x25, READ_AK);
        driver.write(0x27, 0x87);
        driver.write(0x19, 99);
        driver.read(0x3A);
        // Samples come every 100 ms from here on.
        driver.wait(0.0999);
        let mut microseconds = -100;
        while driver.read(0x3A) & 1 == 0 {
            driver.wait(10e-6);
            microseconds += 10;
        }
        assert!(
            (earliest..earliest + 60).contains(&microseconds),
            "{microseconds} µs after the sample"
        );
    }
}

#[test]
fn resetting_the_master_in_mid_transfer_hangs_its_slave() {
    let mut driver = master();
    driver.write(0x25, READ_AK);
    driver.write(0x27, 0x87);
    driver.wait(0.0101);
    driver.write(0x6A, 0x22);
    assert_eq!(driver.complaints(), [Complaint::MasterResetWhileBusy]);
    driver.wait(0.005);
    assert_eq!(driver.read(0x36) & 1, 1, "no answer any more");
}

/// AK 6.4.3.2: what ends while data is being read is skipped. A master that reads ST1 to ST2 at every sample reads data
/// for 160 of 1000 µs, HXL to ST2 at 400 kHz; at DRDY alone nothing is skipped.
#[test]
fn a_master_that_reads_at_every_sample_makes_the_magnetometer_skip_measurements() {
    let mut part = Part::perfect();
    // Through all phases between the two clocks, ten times.
    part.magnetic.clock_error = 0.001;
    let mut driver = master_of(part);
    write_through(&mut driver, 0x0A, 0x16);
    driver.write(0x25, READ_AK);
    driver.write(0x26, 0x02);
    driver.write(0x27, 0x88);
    driver.wait(0.1);
    let mut fresh = 0;
    for _ in 0..10_000 {
        driver.wait_periods(1, 1_000);
        fresh += u32::from(driver.read(0x49) & 1);
    }
    assert!((810..=860).contains(&fresh), "{fresh} of 1001");
    assert_eq!(driver.complaints(), []);
}
