//! The AK8963 through the bypass (data sheet MS1356-E-02).

use std::sync::Arc;

use vrduino_emulator::motion::{Instant, Motion};
use vrduino_emulator::mpu9250::Part;
use vrduino_emulator::mpu9250::complaint::Complaint;
use vrduino_emulator::mpu9250::part::Magnetic;

use crate::driver::{AK, Driver, Feeling, NOTHING, at_rest, in_field, little_endian};

/// Mode, with 16 bits.
const SINGLE: u8 = 0x11;
const CONTINUOUS_8_HZ: u8 = 0x12;
const CONTINUOUS_100_HZ: u8 = 0x16;
const SELF_TEST: u8 = 0x18;
const FUSE_ROM: u8 = 0x0F;

const DRDY: u8 = 0x01;
const DOR: u8 = 0x02;
const HOFL: u8 = 0x08;
const BITM: u8 = 0x10;

impl Driver {
    fn compass(motion: Arc<dyn Motion>) -> Driver {
        Driver::compass_of(motion, Part::perfect())
    }

    fn compass_of(motion: Arc<dyn Motion>, part: Part) -> Driver {
        let mut driver = Driver::new(motion, part);
        driver.bypass();
        driver
    }

    fn set(&mut self, register: u8, value: u8) {
        assert!(self.write_to(AK, &[register, value]));
    }

    fn get(&mut self, register: u8) -> u8 {
        self.get_many(register, 1)[0]
    }

    fn get_many(&mut self, register: u8, count: usize) -> Vec<u8> {
        self.read_from(AK, register, count)
            .expect("the magnetometer answers")
    }

    /// HXL to ST2: the field in counts, and the status.
    fn field(&mut self) -> (Vec<i16>, u8) {
        let bytes = self.get_many(0x03, 7);
        (little_endian(&bytes[..6]), bytes[6])
    }
}

/// A field along the body's x that grows by 15 µT (100 counts) a second.
fn growing() -> Arc<dyn Motion> {
    Arc::new(Feeling(|t| Instant {
        field: Some([15.0 * t, 0.0, 0.0]),
        ..NOTHING
    }))
}

#[test]
fn it_names_itself_on_the_main_bus_only_while_bypassed() {
    let mut driver = Driver::perfect(at_rest());
    assert_eq!(driver.read_from(AK, 0x00, 1), None);
    driver.bypass();
    assert_eq!(driver.get(0x00), 0x48);
    driver.write(0x6A, 0x20);
    assert_eq!(
        driver.read_from(AK, 0x00, 1),
        None,
        "the master owns the bus"
    );
}

/// MPU-9250 product specification, section 9.1: x and y are exchanged, z points down.
#[test]
fn its_axes_are_not_those_of_the_accelerometer() {
    let mut driver = Driver::compass(in_field([15.0, 30.0, 45.0]));
    driver.set(0x0A, SINGLE);
    driver.wait(0.009);
    assert_eq!(driver.field(), (vec![200, 100, -300], BITM));
}

#[test]
fn a_count_is_150_nanotesla_in_sixteen_bits_and_600_in_fourteen() {
    for (mode, counts, status) in [(0x01, 50, 0), (0x11, 200, BITM)] {
        let mut driver = Driver::compass(in_field([30.0, 0.0, 0.0]));
        driver.set(0x0A, mode);
        driver.wait(0.009);
        assert_eq!(driver.field(), (vec![0, counts, 0], status));
    }
}

#[test]
fn a_single_measurement_takes_7_2_ms_and_ends_in_power_down() {
    let mut driver = Driver::compass(in_field([30.0, 0.0, 0.0]));
    driver.set(0x0A, SINGLE);
    driver.wait(0.0071);
    assert_eq!(driver.get(0x02), 0);
    assert_eq!(driver.get(0x0A), SINGLE);
    driver.wait(0.0002);
    assert_eq!(driver.get(0x02), DRDY);
    assert_eq!(driver.get(0x0A), 0x10);
    driver.get(0x04);
    assert_eq!(driver.get(0x02), 0, "reading any data clears DRDY");
}

#[test]
fn continuous_modes_measure_8_and_100_times_a_second() {
    for (mode, hz) in [(CONTINUOUS_8_HZ, 8), (CONTINUOUS_100_HZ, 100)] {
        let mut driver = Driver::compass(in_field([30.0, 0.0, 0.0]));
        driver.set(0x0A, mode);
        let mut measurements = 0;
        for _ in 0..4_000 {
            driver.wait_periods(1, 4_000);
            if driver.get(0x02) & DRDY != 0 {
                measurements += 1;
                assert_eq!(driver.field().1 & HOFL, 0);
            }
        }
        assert_eq!(measurements, hz);
    }
}

#[test]
fn an_unread_measurement_is_overwritten_and_shows_as_overrun() {
    let mut driver = Driver::compass(growing());
    driver.set(0x0A, CONTINUOUS_100_HZ);
    driver.wait(0.028);
    assert_eq!(driver.get(0x02), DRDY | DOR);
    let (field, _) = driver.field();
    assert_eq!(
        field[1], 12,
        "of the third measurement, 0.1236 s after power-on"
    );
    assert_eq!(driver.get(0x02), 0, "both end with the reading");
}

/// Figure 6.8: the data being read stays until ST2 is read, and what came between is skipped.
#[test]
fn data_is_held_until_st2_is_read() {
    let mut driver = Driver::compass(growing());
    driver.set(0x0A, CONTINUOUS_100_HZ);
    driver.wait(0.008);
    let first = driver.get_many(0x03, 6);
    driver.wait(0.100);
    assert_eq!(driver.get(0x02), DOR, "skipped, and nothing new to read");
    assert_eq!(driver.complaints(), []);
    assert_eq!(driver.get_many(0x03, 6), first);
    assert_eq!(driver.complaints(), [Complaint::MagStatus2NotRead]);
    driver.get(0x09);
    driver.wait(0.010);
    assert_eq!(driver.get(0x02), DRDY | DOR);
    assert_ne!(driver.get_many(0x03, 6), first);
}

/// Section 6.4.3.6: the sum of the three counts, not one axis.
#[test]
fn overflow_is_where_the_sum_of_the_axes_reaches_4912_microtesla() {
    for (field, overflow) in [
        ([1637.0, 1637.0, 1637.0], false),
        ([1638.0, -1638.0, 1638.0], true),
        ([4911.0, 0.0, 0.0], false),
        ([0.0, 0.0, -4912.0], true),
    ] {
        let mut driver = Driver::compass(in_field(field));
        driver.set(0x0A, SINGLE);
        driver.wait(0.009);
        assert_eq!(driver.field().1 & HOFL != 0, overflow, "{field:?}");
    }
}

#[test]
fn the_largest_counts_are_32760_and_8190() {
    for (mode, largest) in [(0x11, 32_760), (0x01, 8_190)] {
        let mut driver = Driver::compass(in_field([6000.0, -6000.0, 0.0]));
        driver.set(0x0A, mode);
        driver.wait(0.009);
        assert_eq!(driver.field().0, [-largest, largest, 0]);
    }
}

/// Section 8.3.11: the true field is the raw count times ((ASA − 128) × 0.5 / 128 + 1).
#[test]
fn the_fuse_rom_tells_how_to_adjust_the_counts() {
    let magnetic = Magnetic {
        adjustment: [178, 128, 64],
        ..Part::perfect().magnetic
    };
    let part = Part {
        magnetic,
        ..Part::perfect()
    };
    let mut driver = Driver::compass_of(in_field([300.0, 300.0, -300.0]), part);
    driver.set(0x0A, FUSE_ROM);
    let adjustment = driver.get_many(0x10, 3);
    assert_eq!(adjustment, [178, 128, 64]);
    driver.set(0x0A, 0x00);
    driver.wait(0.0001);
    driver.set(0x0A, SINGLE);
    driver.wait(0.009);
    let (raw, _) = driver.field();
    for (raw, asa) in raw.into_iter().zip(adjustment) {
        let factor = (f64::from(asa) - 128.0) * 0.5 / 128.0 + 1.0;
        assert!(
            (f64::from(raw) * factor * 0.15 - 300.0).abs() < 0.1,
            "{raw}"
        );
    }
    driver.get_many(0x10, 3);
    assert_eq!(driver.complaints(), [Complaint::MagFuseRomClosed]);
}

#[test]
fn modes_change_through_power_down_and_100_microseconds() {
    let mut driver = Driver::compass(at_rest());
    driver.set(0x0A, CONTINUOUS_8_HZ);
    driver.set(0x0A, CONTINUOUS_100_HZ);
    assert_eq!(driver.get(0x0A), CONTINUOUS_8_HZ, "not taken");
    driver.set(0x0A, 0x00);
    driver.wait(0.000_09);
    driver.set(0x0A, CONTINUOUS_100_HZ);
    assert_eq!(driver.get(0x0A), 0x00, "too soon");
    driver.wait(0.000_01);
    driver.set(0x0A, CONTINUOUS_100_HZ);
    assert_eq!(driver.get(0x0A), CONTINUOUS_100_HZ);
    driver.set(0x0A, 0x03);
    assert_eq!(
        driver.complaints(),
        [
            Complaint::MagModeWithoutPowerDown { from: 2, to: 6 },
            Complaint::MagModeTooSoon,
            Complaint::MagModeProhibited(3),
        ]
    );
}

#[test]
fn self_test_meets_the_makers_criterion() {
    let mut driver = Driver::compass_of(in_field([30.0, 0.0, 40.0]), Part::typical(5));
    driver.set(0x0A, FUSE_ROM);
    let adjustment = driver.get_many(0x10, 3);
    driver.set(0x0A, 0x00);
    driver.set(0x0C, 0x40);
    driver.wait(0.0001);
    driver.set(0x0A, SELF_TEST);
    driver.wait(0.009);
    assert_eq!(driver.get(0x02), DRDY);
    let (raw, _) = driver.field();
    let adjusted: Vec<f64> = raw
        .into_iter()
        .zip(adjustment)
        .map(|(raw, asa)| f64::from(raw) * ((f64::from(asa) - 128.0) * 0.5 / 128.0 + 1.0))
        .collect();
    assert!(adjusted[0].abs() <= 200.0 && adjusted[1].abs() <= 200.0);
    assert!((-3200.0..=-800.0).contains(&adjusted[2]), "{adjusted:?}");
    assert_eq!(driver.get(0x0A) & 0xF, 0, "back in power-down");
    assert_eq!(driver.complaints(), []);
}

#[test]
fn self_test_without_its_field_and_reserved_bits_are_complained_about() {
    let mut driver = Driver::compass(at_rest());
    driver.set(0x0A, SELF_TEST);
    driver.set(0x0C, 0x01);
    driver.get(0x0D);
    driver.set(0x02, 0x01);
    assert_eq!(
        driver.complaints(),
        [
            Complaint::MagSelfTestWithoutField,
            Complaint::MagReservedSelfTestBit,
            Complaint::MagReservedRegister(0x0D),
            Complaint::MagReadOnlyRegister(0x02),
        ]
    );
}

#[test]
fn soft_reset_and_external_trigger() {
    let mut driver = Driver::compass(in_field([30.0, 0.0, 0.0]));
    driver.set(0x0A, 0x14);
    driver.wait(1.0);
    assert_eq!(driver.get(0x02), 0, "the trigger pin is not connected");
    driver.set(0x0B, 0x01);
    assert_eq!(driver.get_many(0x0A, 3), [0, 0, 0]);
    driver.wait(0.0001);
    driver.set(0x0A, CONTINUOUS_100_HZ);
    driver.wait(0.02);
    assert_eq!(driver.get(0x02) & DRDY, DRDY);
}

#[test]
fn addresses_run_in_two_rings() {
    let mut driver = Driver::compass(at_rest());
    let bytes = driver.get_many(0x0C, 3);
    assert_eq!(bytes[1..], [0x48, 0x9A], "after ASTC comes WIA");
    driver.set(0x0A, FUSE_ROM);
    assert_eq!(driver.get_many(0x12, 2), [128, 128]);
    assert_eq!(driver.complaints(), []);
}

#[test]
fn its_interface_can_be_disabled_until_it_loses_power() {
    let mut driver = Driver::compass(at_rest());
    driver.set(0x0F, 0x1B);
    assert_eq!(driver.read_from(AK, 0x00, 1), None);
    assert_eq!(driver.complaints(), [Complaint::MagI2cDisabled]);
    driver.sensor.brown_out(driver.now);
    driver.wait(0.02);
    driver.bypass();
    assert_eq!(driver.get(0x00), 0x48);
}
