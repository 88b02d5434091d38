//! How often samples come (RM 4.4, 4.5, 4.9; PS 3.4.2), and that looking does not change them.

use vrduino_emulator::mpu9250::Part;
use vrduino_emulator::time::{SECOND, Ticks};

use crate::driver::{Driver, about_x, at_rest};

/// Samples in `seconds`, counted by data ready at 100 kHz.
fn samples(driver: &mut Driver, seconds: f64) -> u32 {
    driver.read(0x3A);
    let steps = (seconds * 100_000.0) as u32;
    (0..steps)
        .map(|_| {
            driver.wait_periods(1, 100_000);
            u32::from(driver.read(0x3A) & 1)
        })
        .sum()
}

#[test]
fn the_sample_rate_follows_filter_and_divider() {
    // FCHOICE_B, DLPF_CFG, SMPLRT_DIV, samples a second.
    let rows = [
        (0, 0, 0, 8_000),
        (0, 0, 9, 8_000), // no divider beside the averaging filter
        (0, 7, 9, 8_000),
        (0, 1, 0, 1_000),
        (0, 6, 1, 500),
        (0, 3, 4, 200),
        (0, 3, 9, 100),
        (0, 3, 99, 10),
        (3, 1, 9, 32_000),
        (1, 1, 0, 32_000),
        (2, 1, 0, 32_000),
    ];
    for (fchoice_b, dlpf, divider, hz) in rows {
        let mut driver = Driver::perfect(at_rest());
        driver.write(0x1B, fchoice_b);
        driver.write(0x19, divider);
        driver.write(0x1A, dlpf);
        assert_eq!(
            samples(&mut driver, 1.0),
            hz,
            "{fchoice_b} {dlpf} {divider}"
        );
    }
    let mut slowest = Driver::perfect(at_rest());
    slowest.write(0x19, 255);
    slowest.write(0x1A, 1);
    assert_eq!(samples(&mut slowest, 2.56), 10, "3.9 Hz");
}

#[test]
fn the_sensors_clock_is_its_own() {
    for error in [-0.01, 0.01] {
        let mut driver = Driver::new(at_rest(), Part::perfect().clock_error(error));
        driver.write(0x1A, 1);
        assert_eq!(
            samples(&mut driver, 2.0),
            if error > 0.0 { 2_020 } else { 1_980 }
        );
    }
}

/// CLKSEL 0 and 6 are the internal oscillator, 7 stops the clock (RM 4.34).
#[test]
fn the_clock_selection_decides_which_error_counts() {
    let part = Part {
        clock_error: 0.01,
        internal_clock_error: -0.02,
        ..Part::perfect()
    };
    for (select, hz) in [(0, 980), (1, 1_010), (5, 1_010), (6, 980), (7, 0)] {
        let mut driver = Driver::new(at_rest(), part);
        driver.write(0x1A, 1);
        driver.write(0x6B, select);
        let found = samples(&mut driver, 1.0);
        assert!(found.abs_diff(hz) <= 1, "{found} with CLKSEL {select}");
    }
    // Without a gyroscope there is nothing to lock to.
    let mut driver = Driver::new(at_rest(), part);
    driver.write(0x6C, 0x07);
    driver.write(0x1A, 1);
    assert!(samples(&mut driver, 1.0).abs_diff(980) <= 1);
}

#[test]
fn the_low_power_accelerometer_wakes_up_at_its_own_rates() {
    for (code, hz) in [(11, 500.0), (8, 62.5), (5, 7.81), (2, 0.98)] {
        let mut driver = Driver::perfect(at_rest());
        driver.write(0x1E, code);
        driver.write(0x6C, 0x07);
        driver.write(0x6B, 0x21);
        let seconds = if hz < 10.0 { 10.0 } else { 2.0 };
        let expected = hz * seconds;
        let found = f64::from(samples(&mut driver, seconds));
        assert!((found - expected).abs() <= 1.0, "{found} at {hz} Hz");
    }
}

fn typical(motion_hz: f64) -> Driver {
    let motion = about_x(move |t| 10.0 * (std::f64::consts::TAU * motion_hz * t).sin());
    let mut driver = Driver::new(motion, Part::typical(7));
    driver.write(0x1B, 0x18);
    driver.write(0x1C, 0x18);
    driver.write(0x1A, 0x03);
    driver.write(0x1D, 0x05);
    driver
}

#[test]
fn what_is_read_does_not_depend_on_how_often() {
    let (mut often, mut seldom) = (typical(3.0), typical(3.0));
    for _ in 0..10 {
        for _ in 0..970 {
            often.wait_periods(1, 10_000);
            often.accel();
        }
        seldom.wait_periods(970, 10_000);
        assert_eq!(often.now, seldom.now);
        assert_eq!(often.words(0x3B, 7), seldom.words(0x3B, 7));
    }
}

/// Far longer than any filter remembers, the steps between are left out.
#[test]
fn a_long_silence_leaves_no_trace() {
    let (mut often, mut seldom) = (typical(0.7), typical(0.7));
    let until: Ticks = often.now + 20 * SECOND;
    while often.now < until {
        often.wait_periods(1, 20);
        often.accel();
    }
    seldom.wait_periods(20, 1);
    assert_eq!(often.words(0x3B, 7), seldom.words(0x3B, 7));
    assert_eq!(often.read(0x3A), seldom.read(0x3A));
}

#[test]
fn the_same_seed_is_the_same_sensor_and_another_is_another() {
    let stream = |part: Part| -> Vec<Vec<i16>> {
        let mut driver = Driver::new(at_rest(), part);
        driver.set_up();
        (0..50)
            .map(|_| {
                driver.wait_periods(1, 1_000);
                driver.words(0x3B, 7)
            })
            .collect()
    };
    assert_eq!(stream(Part::typical(3)), stream(Part::typical(3)));
    assert_ne!(stream(Part::typical(3)), stream(Part::typical(4)));
}

#[test]
fn a_copy_of_the_sensor_goes_on_as_the_original_does() {
    let mut original = typical(2.0);
    original.wait(0.3);
    original.accel();
    let mut copy = Driver {
        sensor: original.sensor.clone(),
        now: original.now,
    };
    for _ in 0..20 {
        original.wait(0.0013);
        copy.wait(0.0013);
        assert_eq!(original.read_many(0x3A, 15), copy.read_many(0x3A, 15));
    }
}
