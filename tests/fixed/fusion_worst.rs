//! The default estimator in integers: what no motion brings, and what only a perfect one does.

use crate::fusion::{rates, unit};
use crate::random::{ODD, Random};
use crate::worst::{ENDS, sample};
use vrduino::fixed::fusion::{Field, Force, Fusion, Nanoseconds, Parameters, Rates};
use vrduino::imu::RANGES;
use vrduino::nalgebra::Vector3;
use vrduino::sensor::{AccelRange, GyroRange, Ranges};
use vrduino::units::Seconds;

fn assert_unit(bits: [i32; 4], allowed: f64, what: impl core::fmt::Debug) {
    let squares: f64 = bits
        .map(|bits| (f64::from(bits) / f64::from(1 << 30)).powi(2))
        .iter()
        .sum();
    assert!((squares.sqrt() - 1.0).abs() < allowed, "{squares} {what:?}");
}

/// Every corner of the input, among them gaps and resets: no sum or shift leaves its range, which a test's build
/// would panic on.
#[test]
fn the_ends_of_every_range_leave_a_unit_quaternion() {
    let mut random = Random(31);
    for round in 0..300 {
        let ranges = Ranges {
            gyro: GyroRange::ALL[round % 4],
            accel: AccelRange::ALL[round / 4 % 4],
        };
        let mut fusion = Fusion::new(&Parameters::default(), rates(ranges));
        for number in 0..3000 {
            let mut end = || ENDS[(random.unit() * ENDS.len() as f64) as usize];
            let sample = sample([end(), end(), end()], [end(), end(), end()]);
            let field = [end(), end(), end()].map(|part| i32::from(part) << 16);
            let force = Force::from_counts(sample.accel);
            match number % 700 {
                300 => fusion.level(force),
                600 => fusion.reset(force),
                _ => {}
            }
            let field = (number % 3 == 0).then(|| Field::from_parts_of_microtesla(field));
            fusion.update(&sample, field);
            assert_unit(fusion.bits(), 1e-6, (ranges, number, sample));
        }
    }
}

#[test]
fn odd_parameters_leave_a_unit_quaternion() {
    let mut random = Random(32);
    for round in 0..20_000 {
        let mut odd = || ODD[(random.unit() * ODD.len() as f64) as usize] as f32;
        let parameters = Parameters {
            tilt_time: Seconds(odd()),
            damping: odd(),
            lead: Seconds(odd()),
            start_time: Seconds(odd()),
            tilt_integral: odd(),
            tilt_integral_start: Seconds(odd()),
            rest_filter_time: Seconds(odd()),
            rest_time: Seconds(odd()),
            rest_rate_dps: odd(),
            rest_force: odd(),
            largest_bias_dps: odd(),
            rest_bias_dps: odd(),
            largest_change_dps: odd(),
            heading_time: Seconds(odd()),
            heading_integral: odd(),
            heading_integral_start: odd(),
            rest_worth: Seconds(odd()),
            field_tolerance: odd(),
            field_time: Seconds(odd()),
            new_field_time: [Seconds(odd()), Seconds(odd())],
        };
        let periods = [0, 1, 125_000, 1_000_000, 7_000_000, u32::MAX];
        let rates = Rates {
            sample: Nanoseconds(periods[round % 6]),
            field: Nanoseconds(periods[round / 6 % 6]),
            ranges: RANGES,
        };
        let mut fusion = Fusion::new(&parameters, rates);
        for number in 0..60 {
            let gyro = random.vector(32_768.0).map(|count| count as i16);
            let accel = random.vector(32_768.0).map(|count| count as i16);
            let field = random.vector(1e9).map(|part| part as i32);
            fusion.update(
                &sample(gyro, accel),
                Some(Field::from_parts_of_microtesla(field)),
            );
            assert_unit(fusion.bits(), 1e-6, (&parameters, rates, number));
        }
    }
}

/// Nothing dithers: 1 g is a power of two of counts in every range, where a reciprocal overflows first.
#[test]
fn a_perfectly_still_sensor_stays_where_it_is() {
    for accel in AccelRange::ALL {
        let one_g = (32768.0 / accel.max_g()) as i16;
        for axis in 0..3 {
            for sign in [1, -1] {
                let mut force = [0; 3];
                force[axis] = sign * one_g;
                let ranges = Ranges {
                    gyro: GyroRange::Dps2000,
                    accel,
                };
                let mut fusion = Fusion::new(&Parameters::default(), rates(ranges));
                fusion.update(&sample([0; 3], force), None);
                let first = unit(fusion.bits());
                let up = first * Vector3::from(force.map(f64::from)).normalize();
                assert!((up - Vector3::y()).norm() < 1e-6, "{force:?} {up:?}");
                for _ in 0..20_000 {
                    fusion.update(&sample([0; 3], force), None);
                }
                let apart = first.angle_to(&unit(fusion.bits())).to_degrees();
                assert!(apart < 1e-4, "{force:?}: {apart:e} degrees");
            }
        }
    }
}

#[test]
fn free_fall_corrects_nothing() {
    let mut fusion = Fusion::new(&Parameters::default(), rates(RANGES));
    for _ in 0..2000 {
        fusion.update(&sample([0; 3], [0, 2048, 0]), None);
    }
    let before = unit(fusion.bits());
    for _ in 0..2000 {
        fusion.update(&sample([0; 3], [0; 3]), None);
    }
    assert!(before.angle_to(&unit(fusion.bits())) < 1e-6);
}
