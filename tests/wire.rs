//! Every line and frame to the byte: a changed one turns a test red before it turns a viewer blank.

#[path = "random/mod.rs"]
mod random;

#[path = "wire/orientation.rs"]
mod orientation;

#[path = "wire/frame.rs"]
mod frame;

#[path = "wire/hosts.rs"]
mod hosts;

#[path = "wire/decoder.rs"]
mod decoder;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use vrduino::calibration::Rest;
use vrduino::orientation::angles::pitch_and_roll;
use vrduino::orientation::flatland::Roll;
use vrduino::units::{Angle, AngularRate, MagneticField, SpecificForce};
use vrduino::wire::{self, Decimals, LINE_LEN, Line, Q30, Tag};

/// A value as ACC prints it: the line holds the number as given.
fn three_decimals(value: f32) -> String {
    let line = wire::force(SpecificForce::from_m_per_s2(Vector3::new(value, 0.0, 0.0)));
    let rest = line.strip_prefix("ACC: ").expect("the tag");
    rest.strip_suffix(" 0.000 0.000\n")
        .expect("the others")
        .into()
}

fn rest() -> Rest {
    Rest {
        gyro_bias: AngularRate::from_dps(Vector3::new(0.17408, -0.19935, 0.44581)),
        gyro_variance_dps2: Vector3::new(0.01, 0.02, 0.000_004),
        force: SpecificForce::from_m_per_s2(Vector3::new(0.37, 9.0, -2.3)),
        force_variance_m2_per_s4: Vector3::new(0.001, 0.002, 0.003),
        temperature_celsius: 25.0,
    }
}

fn check(line: &Line, expected: &str) {
    assert_eq!(line.as_bytes(), expected.as_bytes());
}

#[test]
fn quaternions_are_scalar_first() {
    let q = UnitQuaternion::new_unchecked(Quaternion::new(0.5, -0.5, 0.1, 0.7));
    check(
        &wire::quaternion(Tag::Fused, Q30::from(&q), Decimals::COURSE),
        "QC 0.500 -0.500 0.100 0.700\n",
    );
    check(
        &wire::quaternion(Tag::Gyro, Q30::from(&q), Decimals::COURSE),
        "QG 0.500 -0.500 0.100 0.700\n",
    );
    let level = UnitQuaternion::identity();
    check(
        &wire::quaternion(Tag::Fused, Q30::from(&level), Decimals::COURSE),
        "QC 1.000 0.000 0.000 0.000\n",
    );
}

#[test]
fn angles_are_pitch_yaw_roll_in_degrees() {
    let force = |x, y, z| SpecificForce::from_m_per_s2(Vector3::new(x, y, z));
    let line = |f| wire::angles(&pitch_and_roll(f));
    check(&line(force(0.0, 9.81, 0.0)), "EA 0.000 0.000 0.000\n");
    check(&line(force(0.0, 0.0, -9.81)), "EA 90.000 0.000 0.000\n");
    check(&line(force(1.0, 1.0, 0.0)), "EA 0.000 0.000 45.000\n");
    check(&line(force(-9.81, 0.0, 0.0)), "EA 0.000 0.000 -90.000\n");
}

#[test]
fn flatland_is_gyro_accelerometer_fused() {
    let roll = Roll {
        gyro: Angle::from_degrees(1.25),
        accelerometer: Angle::from_degrees(-179.5),
        fused: Angle::from_degrees(0.0),
    };
    check(&wire::flat(&roll), "FLAT 1.250 -179.500 0.000\n");
}

#[test]
fn the_tags_of_raw_readings_have_a_colon() {
    let rate = AngularRate::from_rad_per_s(Vector3::new(std::f32::consts::PI, 0.0, -1.0));
    check(&wire::gyro(rate), "GYR: 180.000 0.000 -57.296\n");
    let force = SpecificForce::from_m_per_s2(Vector3::new(0.12, 9.806, -0.5));
    check(&wire::force(force), "ACC: 0.120 9.806 -0.500\n");
}

#[test]
fn the_info_block_has_five_decimals() {
    let rest = rest();
    check(&wire::reads_per_second(987), "nReads/sec: 987\n");
    check(
        &wire::gyro_bias(rest.gyro_bias),
        "GYR_BIAS: 0.17408 -0.19935 0.44581\n",
    );
    check(
        &wire::gyro_variance(&rest),
        "GYR_VAR: 0.01000 0.02000 0.00000\n",
    );
    check(
        &wire::force_mean(&rest),
        "ACC_BIAS: 0.37000 9.00000 -2.30000\n",
    );
    check(
        &wire::force_variance(&rest),
        "ACC_VAR: 0.00100 0.00200 0.00300\n",
    );
    check(&wire::dropped(0), "DROPPED: 0\n");
    check(&wire::repeated(10), "REPEATED: 10\n");
    check(&wire::overruns(u32::MAX), "OVERRUNS: 4294967295\n");
    check(&wire::no_field(), "Field: none\n");
    check(&wire::fields_skipped(2), "FIELDS_SKIPPED: 2\n");
    let field = MagneticField::from_microtesla(Vector3::new(-20.55, 0.0, 4911.999));
    check(
        &wire::field(field, 100),
        "Field: -20.550 0.000 4911.999 uT (100 Hz)\n",
    );
    check(
        &wire::bias_measured(rest.gyro_bias),
        "Bias: 0.174 -0.199 0.446 deg/s (still)\n",
    );
}

#[test]
fn decimals_are_rounded_to_the_nearest_and_halves_away_from_zero() {
    for (value, text) in [
        (0.0, "0.000"),
        (-0.0, "0.000"),
        (-0.000_4, "0.000"),
        (0.000_499_99, "0.000"),
        (0.000_500_01, "0.001"),
        (-0.000_500_01, "-0.001"),
        (0.062_5, "0.063"), // exactly a half: C prints 0.062, the even neighbour
        (-0.062_5, "-0.063"),
        (0.187_5, "0.188"),
        (0.999_499, "0.999"),
        (0.999_51, "1.000"),
        (9.81, "9.810"),
        (-156.96, "-156.960"),
        (123_456.79, "123456.789"),
        (999_999.94, "999999.938"),
        (f32::MIN_POSITIVE, "0.000"),
        (f32::from_bits(1), "0.000"),
    ] {
        assert_eq!(three_decimals(value), text, "{value}");
    }
}

#[test]
fn decimals_agree_with_exact_arithmetic_over_the_whole_range() {
    // Every exponent, a few hundred significands each; f64 holds all the products exactly.
    for high in (0..0x4980_u32).step_by(3) {
        let value = f32::from_bits((high << 16) | (high.wrapping_mul(40_503) & 0xFFFF));
        if value >= 999_999.9 {
            continue;
        }
        let steps = (f64::from(value) * 1000.0 + 0.5).floor() as u64;
        let expected = format!("{}.{:03}", steps / 1000, steps % 1000);
        assert_eq!(three_decimals(value), expected, "{value:e}");
    }
}

#[test]
fn what_is_no_number_is_still_digits() {
    for (value, text) in [
        (1e6, "999999.999"),
        (-1e6, "-999999.999"),
        (f32::MAX, "999999.999"),
        (f32::INFINITY, "999999.999"),
        (f32::NEG_INFINITY, "-999999.999"),
        (f32::NAN, "0.000"),
        (-f32::NAN, "0.000"),
    ] {
        assert_eq!(three_decimals(value), text, "{value}");
    }
    let rate = AngularRate::from_dps(Vector3::repeat(f32::NEG_INFINITY));
    check(
        &wire::gyro_bias(rate),
        "GYR_BIAS: -999999.99900 -999999.99900 -999999.99900\n",
    );
}

#[test]
fn a_printed_quaternion_is_a_rotation_to_two_parts_in_a_thousand() {
    let mut state = 1_u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
    };
    for _ in 0..20_000 {
        let q = Quaternion::new(random(), random(), random(), random());
        let q = UnitQuaternion::new_normalize(q);
        let line = wire::quaternion(Tag::Fused, Q30::from(&q), Decimals::COURSE);
        let numbers: Vec<f64> = line
            .strip_prefix("QC ")
            .and_then(|rest| rest.strip_suffix('\n'))
            .expect("tag and newline")
            .split(' ')
            .map(|number| number.parse().expect("a number"))
            .collect();
        let norm = numbers.iter().map(|n| n * n).sum::<f64>().sqrt();
        assert_eq!(numbers.len(), 4);
        assert!((norm - 1.0).abs() < 0.002, "{line}");
        // The course's Unity script wants a whole line in every 64 bytes.
        assert!(line.len() <= 32, "{line}");
    }
}

#[test]
fn a_message_is_one_line_whatever_it_says() {
    check(&wire::text("Measuring bias"), "Measuring bias\n");
    check(&wire::text(""), "\n");
    check(&wire::text("two\r\nlines\n"), "two  lines \n");
    check(
        &wire::text(format_args!("register 0x{:02X}", 27)),
        "register 0x1B\n",
    );
    let longest = "x".repeat(LINE_LEN - 1);
    check(&wire::text(&longest), &format!("{longest}\n"));
    check(&wire::text("x".repeat(1000)), &format!("{longest}\n"));
    // Cut between characters, never within one.
    let line = wire::text("°".repeat(1000));
    assert_eq!(line.len(), LINE_LEN - 1);
    assert!(line.ends_with("°\n"));
}
