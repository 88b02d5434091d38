//! Counts for what is felt: ranges, saturation, temperature, offsets (PS 3.1, 3.2, 3.4.2; RM 4.3, 4.23, 4.39).

use vrduino_emulator::motion::Instant;
use vrduino_emulator::mpu9250::Part;
use vrduino_emulator::mpu9250::part::Temperature;

use crate::driver::{Driver, G, NOTHING, about_x, at_rest, constant};

/// A driver whose gyroscope and accelerometer are set to range `select`.
fn at_range(select: u8, instant: Instant) -> Driver {
    let mut driver = Driver::perfect(constant(instant));
    driver.write(0x1B, select << 3);
    driver.write(0x1C, select << 3);
    driver.write(0x1A, 0x01);
    driver.wait(0.1);
    driver
}

#[test]
fn every_range_has_its_sensitivity_and_every_axis_its_place() {
    let instant = Instant {
        rate: [
            100f64.to_radians(),
            -200f64.to_radians(),
            50f64.to_radians(),
        ],
        force: [1.0 * G, -0.5 * G, 1.5 * G],
        ..NOTHING
    };
    let sensitivities = [
        (0, 131.0, 16_384.0),
        (1, 65.5, 8_192.0),
        (2, 32.8, 4_096.0),
        (3, 16.4, 2_048.0),
    ];
    for (select, per_dps, per_g) in sensitivities {
        let mut driver = at_range(select, instant);
        for (counts, dps) in driver.gyro().into_iter().zip([100.0, -200.0, 50.0]) {
            let expected = dps * per_dps;
            // The table prints three digits.
            assert!(
                (f64::from(counts) - expected).abs() <= (expected * 0.0015).abs() + 0.5,
                "{counts} for {dps} °/s at range {select}"
            );
        }
        for (counts, g) in driver.accel().into_iter().zip([1.0, -0.5, 1.5]) {
            assert_eq!(f64::from(counts), g * per_g, "{g} g at range {select}");
        }
    }
}

#[test]
fn beyond_the_range_the_output_stays_at_its_end() {
    let mut driver = at_range(
        0,
        Instant {
            rate: [5.0, -5.0, 0.0],
            force: [2.5 * G, -2.5 * G, 0.0],
            ..NOTHING
        },
    );
    assert_eq!(driver.gyro(), [32_767, -32_768, 0]);
    assert_eq!(driver.accel(), [32_767, -32_768, 0]);
}

#[test]
fn the_temperature_is_zero_counts_at_21_degrees_and_333_87_a_degree() {
    for (celsius, counts) in [(21.0, 0), (25.0, 1335), (-40.0, -20_366), (85.0, 21_368)] {
        let mut driver = Driver::new(at_rest(), Part::perfect().temperature(celsius));
        driver.set_up();
        assert_eq!(driver.words(0x41, 1), [counts], "{celsius} °C");
    }
}

#[test]
fn a_part_may_warm_up() {
    let temperature = Temperature {
        celsius: 21.0,
        warm_up: 10.0,
        time_constant: 5.0,
    };
    let part = Part {
        temperature,
        ..Part::perfect()
    };
    let mut driver = Driver::new(at_rest(), part);
    driver.set_up();
    driver.wait(4.8);
    let celsius = f64::from(driver.words(0x41, 1)[0]) / 333.87 + 21.0;
    assert!(
        (celsius - (31.0 - 10.0 / std::f64::consts::E)).abs() < 0.02,
        "{celsius}"
    );
}

#[test]
fn disabled_axes_read_zero_and_the_powered_down_thermometer_too() {
    let instant = Instant {
        rate: [1.0; 3],
        force: [G; 3],
        ..NOTHING
    };
    let mut driver = at_range(3, instant);
    for bit in 0..6 {
        driver.write(0x6C, 1 << bit);
        driver.wait(0.1);
        // Bits 5 to 3 are the accelerometer's x, y, z, bits 2 to 0 the gyroscope's.
        let axes = [driver.accel(), driver.gyro()].concat();
        let zero: Vec<usize> = (0..6).filter(|&axis| axes[axis] == 0).collect();
        assert_eq!(zero, [5 - bit]);
    }
    assert_ne!(driver.words(0x41, 1), [0]);
    driver.write(0x6B, 0x09);
    driver.wait(0.1);
    assert_eq!(driver.words(0x41, 1), [0]);
}

/// RM 4.3: four counts at ±250 °/s; RM 4.39: 15 bits of 0.98 mg. Signs as the maker's driver uses them: a bias is
/// removed by writing its negative.
#[test]
fn offset_registers_remove_a_bias() {
    let mut driver = at_range(
        0,
        Instant {
            rate: [2f64.to_radians(), 0.0, 0.0],
            force: [0.0, 0.0, 0.098 * G],
            ..NOTHING
        },
    );
    let bias = driver.gyro()[0];
    let [high, low] = (-bias / 4).to_be_bytes();
    driver.write(0x13, high);
    driver.write(0x14, low);
    let [high, low] = (-100_i16 << 1).to_be_bytes();
    driver.write(0x7D, high);
    driver.write(0x7E, low);
    driver.wait(0.1);
    assert!(driver.gyro()[0].abs() <= 4, "{:?}", driver.gyro());
    assert!(driver.accel()[2].abs() <= 1, "{:?}", driver.accel());
}

#[test]
fn the_frame_pin_takes_the_last_bit_of_the_chosen_output() {
    let mut driver = Driver::perfect(about_x(|_| 1.0));
    driver.write(0x1B, 0x00);
    driver.write(0x1A, 0x01);
    driver.wait(0.1);
    assert_eq!(driver.gyro()[0], 131);
    driver.write(0x1A, 2 << 3 | 1);
    driver.wait(0.1);
    assert_eq!(driver.gyro()[0], 130);
}

#[test]
fn outputs_hold_still_during_a_burst() {
    use vrduino_emulator::peripherals::i2c::Target;
    let mut driver = Driver::perfect(about_x(|t| 1000.0 * t));
    driver.set_up();
    let quiet = driver.words(0x3B, 7);
    let now = driver.now;
    assert!(driver.sensor.address(0xD0, now) && driver.sensor.write(0x3B, now));
    assert!(driver.sensor.address(0xD1, now));
    // A byte a millisecond: fourteen samples pass.
    let slow: Vec<u8> = (0..14)
        .map(|byte| driver.sensor.read(now + byte * 144_000))
        .collect();
    assert_eq!(crate::driver::big_endian(&slow), quiet);
}
