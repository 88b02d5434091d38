//! Self-test as the application note prescribes it (AN-MPU-9250A-03, section 3).

use vrduino_emulator::mpu9250::Part;
use vrduino_emulator::mpu9250::part::SelfTest;

use crate::driver::{Driver, at_rest};

/// Mean of 200 readings at 1 kHz: gyroscope, accelerometer.
fn average(driver: &mut Driver) -> [f64; 6] {
    let mut sums = [0.0; 6];
    for _ in 0..200 {
        driver.wait_periods(1, 1_000);
        let readings = driver.gyro().into_iter().chain(driver.accel());
        for (sum, counts) in sums.iter_mut().zip(readings) {
            *sum += f64::from(counts) / 200.0;
        }
    }
    sums
}

/// Response over the factory's, for the gyroscope's and the accelerometer's axes.
fn ratios(part: Part) -> [f64; 6] {
    let mut driver = Driver::new(at_rest(), part);
    driver.write(0x1A, 0x02);
    driver.write(0x1D, 0x02);
    driver.write(0x1B, 0x00);
    driver.write(0x1C, 0x00);
    driver.wait(0.1);
    let without = average(&mut driver);
    driver.write(0x1B, 0xE0);
    driver.write(0x1C, 0xE0);
    driver.wait(0.02);
    let with = average(&mut driver);
    let gyro_codes = driver.read_many(0x00, 3);
    let accel_codes = driver.read_many(0x0D, 3);
    let codes: Vec<u8> = gyro_codes.into_iter().chain(accel_codes).collect();
    std::array::from_fn(|axis| {
        let factory = 2620.0 * 1.01f64.powi(i32::from(codes[axis]) - 1);
        (with[axis] - without[axis]) / factory
    })
}

#[test]
fn a_perfect_part_answers_as_at_the_factory() {
    for ratio in ratios(Part::perfect()) {
        assert!((ratio - 1.0).abs() < 0.002, "{ratio}");
    }
}

#[test]
fn every_part_within_the_data_sheet_passes_and_a_broken_axis_does_not() {
    for seed in 0..4 {
        for part in [Part::typical(seed), Part::worst(seed)] {
            for ratio in ratios(part) {
                assert!((0.5..1.5).contains(&ratio), "{ratio} of seed {seed}");
            }
        }
    }
    let broken = Part {
        gyro_self_test: SelfTest {
            ratio: [1.0, 0.3, 1.0],
            ..Part::perfect().gyro_self_test
        },
        ..Part::perfect()
    };
    assert!(ratios(broken)[1] < 0.5);
}

#[test]
fn each_axis_is_actuated_by_its_own_bit() {
    for (bit, axis) in [(0x80, 0), (0x40, 1), (0x20, 2)] {
        let mut driver = Driver::perfect(at_rest());
        driver.write(0x1B, bit);
        driver.write(0x1C, bit);
        driver.wait(0.1);
        for counts in [driver.gyro(), driver.accel()] {
            for (other, count) in counts.into_iter().enumerate() {
                assert_eq!(count != 0, other == axis, "{bit:#04x}: {count}");
            }
        }
    }
}
