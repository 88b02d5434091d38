//! Reset values, what may be written, start-up, resets (RM 3 and 4; PS 3.4.2).

use vrduino_emulator::mpu9250::complaint::Complaint;
use vrduino_emulator::mpu9250::{Mpu9250, Part};
use vrduino_emulator::time::MILLISECOND;

use crate::driver::{AK, Driver, MPU, at_rest};

#[test]
fn registers_reset_to_zero_but_for_these() {
    let mut driver = Driver::perfect(at_rest());
    for register in 0x00..=0x7F_u8 {
        let expected = match register {
            0x00..=0x02 | 0x0D..=0x0F => continue, // factory's self-test codes
            0x3A..=0x48 => continue,               // measurements
            0x6B => 0x01,
            0x75 => 0x71,
            _ => 0x00,
        };
        assert_eq!(driver.read(register), expected, "register {register:#04x}");
    }
}

#[test]
fn what_is_written_is_read_back_and_what_cannot_be_written_is_complained_about() {
    let read_write = [
        0x00..=0x02,
        0x0D..=0x0F,
        0x13..=0x1D,
        0x1F..=0x1F,
        0x23..=0x26,
        0x63..=0x67,
        0x69..=0x69,
        0x77..=0x78,
        0x7A..=0x7B,
        0x7D..=0x7E,
    ];
    let mut driver = Driver::perfect(at_rest());
    for register in read_write.into_iter().flatten() {
        driver.write(register, 0x15);
        assert_eq!(driver.read(register), 0x15, "register {register:#04x}");
    }
    assert_eq!(driver.complaints(), []);
    driver.write(0x75, 0x15);
    driver.write(0x3B, 0x15);
    driver.write(0x20, 0x15);
    driver.write(0x20, 0x15);
    assert_eq!(driver.read(0x75), 0x71);
    assert_eq!(driver.read(0x20), 0);
    assert_eq!(
        driver.complaints(),
        [
            Complaint::ReadOnlyRegister(0x75),
            Complaint::ReadOnlyRegister(0x3B),
            Complaint::ReservedRegister(0x20),
        ]
    );
    assert_eq!(
        Complaint::ReservedRegister(0x20).to_string(),
        "write to the reserved register 0x20"
    );
    assert_eq!(driver.sensor.complaints.take().len(), 3);
    assert_eq!(driver.complaints(), []);
}

#[test]
fn the_sensor_answers_eleven_milliseconds_after_power_on() {
    let mut driver = Driver {
        sensor: Mpu9250::new(at_rest(), Part::perfect()),
        now: 11 * MILLISECOND - 1,
    };
    assert_eq!(driver.read_from(MPU, 0x75, 1), None);
    driver.now += 1;
    assert_eq!(driver.read_from(MPU, 0x75, 1), Some(vec![0x71]));
    assert_eq!(driver.complaints(), [], "a host may ask who is there");
}

#[test]
fn a_device_reset_restores_the_defaults_and_must_be_waited_for() {
    let mut driver = Driver::perfect(at_rest());
    driver.set_up();
    driver.write(0x6B, 0x80);
    driver.wait(0.001);
    assert_eq!(driver.read_from(MPU, 0x75, 1), None);
    assert_eq!(driver.complaints(), [Complaint::BusyAfterReset]);
    driver.wait(0.01);
    assert_eq!(driver.read_many(0x1A, 4), [0; 4]);
    assert_eq!(driver.read(0x6B), 0x01);
}

#[test]
fn spi_only_mode_silences_the_sensor_until_it_loses_power() {
    let mut driver = Driver::perfect(at_rest());
    driver.write(0x6A, 0x10);
    assert_eq!(driver.read_from(MPU, 0x75, 1), None);
    assert_eq!(driver.complaints(), [Complaint::I2cDisabled]);
    driver.sensor.brown_out(driver.now);
    driver.wait(0.02);
    assert_eq!(driver.read(0x75), 0x71);
}

#[test]
fn family_and_clones_differ_in_who_am_i_and_in_the_magnetometer() {
    for (who_am_i, magnetometer) in [(0x71, true), (0x73, true), (0x70, false), (0x75, false)] {
        let mut driver = Driver::new(at_rest(), Part::perfect().who_am_i(who_am_i));
        driver.bypass();
        assert_eq!(driver.read(0x75), who_am_i);
        let wia = driver.read_from(AK, 0x00, 1);
        assert_eq!(wia, magnetometer.then(|| vec![0x48]), "{who_am_i:#04x}");
    }
    let mut driver = Driver::new(at_rest(), Part::perfect().without_magnetometer());
    driver.bypass();
    assert_eq!(driver.read_from(AK, 0x00, 1), None);
}

#[test]
fn only_its_own_address_is_acknowledged() {
    let mut driver = Driver::perfect(at_rest());
    let answering: Vec<u8> = (0..=0x7F)
        .filter(|&address| driver.write_to(address, &[]))
        .collect();
    assert_eq!(answering, [MPU]);
}
