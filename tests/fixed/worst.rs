//! What no motion brings, and what only a perfect one does.

use crate::random::Random;
use crate::reference::{Pair, degrees_apart, orientation};
use vrduino::calibration::GyroBias;
use vrduino::fixed::complementary::{Bias, Complementary, Force, Nanoseconds, Parameters};
use vrduino::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use vrduino::orientation::TimeConstant;
use vrduino::sensor::{AccelRange, GyroRange, Ranges, RawSample};
use vrduino::units::{AngularRate, Seconds};

pub fn sample(gyro: [i16; 3], accel: [i16; 3]) -> RawSample {
    RawSample {
        gyro,
        accel,
        temperature: 0,
        fresh: true,
    }
}

fn filter(gyro: GyroRange, nanoseconds: u32, time: f32) -> Complementary {
    Complementary::new(&Parameters {
        gyro,
        sample_period: Nanoseconds(nanoseconds),
        time_constant: TimeConstant::new(Seconds(time)),
    })
}

fn assert_unit(filter: &Complementary, what: impl core::fmt::Debug) {
    let squares: f64 = filter
        .bits()
        .map(|bits| (f64::from(bits) / f64::from(1 << 30)).powi(2))
        .iter()
        .sum();
    assert!((squares.sqrt() - 1.0).abs() < 1e-8, "{squares} {what:?}");
}

pub const ENDS: [i16; 9] = [
    i16::MIN,
    i16::MIN + 1,
    -16384,
    -1,
    0,
    1,
    16384,
    i16::MAX - 1,
    i16::MAX,
];

/// Nothing dithers: 1 g is a power of two of counts in every range, where a reciprocal overflows first.
#[test]
fn a_perfectly_still_sensor_stays_where_it_is() {
    for accel in AccelRange::ALL {
        let one_g = (32768.0 / accel.max_g()) as i16;
        for axis in 0..3 {
            for sign in [1, -1] {
                let mut force = [0; 3];
                force[axis] = sign * one_g;
                let still = sample([0; 3], force);
                let ranges = Ranges {
                    gyro: GyroRange::Dps2000,
                    accel,
                };
                for reset in [true, false] {
                    let mut pair = Pair::new(ranges, 1.0, [0; 3]);
                    if reset {
                        pair.reset(&still);
                    }
                    let worst = (0..20_000).map(|_| pair.update(&still)).fold(0.0, f64::max);
                    assert!(worst <= 1e-4, "{still:?} {reset}: {worst:e} degrees");
                }
            }
        }
    }
}

/// The up direction of the sensor is up in the world after a reset, whatever the force.
#[test]
fn a_reset_levels_any_force() {
    let mut random = Random(11);
    let mut forces: Vec<[i16; 3]> = (0..100_000)
        .map(|_| random.vector(32767.0).map(|counts| counts as i16))
        .collect();
    for x in ENDS {
        for y in ENDS {
            for z in ENDS {
                forces.push([x, y, z]);
            }
        }
    }
    for force in forces {
        let mut filter = filter(GyroRange::Dps2000, 1_000_000, 7.6);
        filter.reset(Force::from_counts(force));
        assert_unit(&filter, force);
        let force = Vector3::from(force.map(f64::from));
        if force.norm() > 0.0 {
            let up = orientation(&filter) * force.normalize();
            let off = up.cross(&Vector3::y()).norm();
            assert!(up.y > 0.0 && off < 1e-6, "{force:?}: {off}");
            // The shortest way: nothing about the vertical.
            assert!(filter.bits()[2].abs() < 20, "{force:?} {:?}", filter.bits());
        } else {
            assert_eq!(filter.bits(), [1 << 30, 0, 0, 0]);
        }
    }
}

/// Every corner of the input, from every corner of the state, with the ends of every parameter.
#[test]
fn the_ends_of_every_range_leave_a_unit_quaternion() {
    let biases = [0, 1 << 29, -1 << 29, i32::MAX, i32::MIN];
    let mut checked = 0_u64;
    for gyro_range in GyroRange::ALL {
        for nanoseconds in [0, 1, 125_000, 1_000_000, 6_700_000, 53_000_000, u32::MAX] {
            for time in [
                0.0,
                0.001,
                0.0069,
                0.0071,
                7.6,
                1e9,
                f32::INFINITY,
                f32::NAN,
                -1.0,
            ] {
                for bias in biases {
                    let mut filter = filter(gyro_range, nanoseconds, time);
                    filter.set_bias(Bias::from_parts_of_counts([bias, -1 - bias, bias]));
                    let mut random = Random(checked + 1);
                    for _ in 0..300 {
                        let mut end = || ENDS[(random.unit() * ENDS.len() as f64) as usize];
                        let sample = sample([end(), end(), end()], [end(), end(), end()]);
                        filter.update(&sample);
                        assert_unit(&filter, (gyro_range, nanoseconds, time, bias, sample));
                        checked += 1;
                    }
                }
            }
        }
    }
    assert!(checked > 300_000);
}

#[test]
fn millions_of_random_samples_leave_a_unit_quaternion() {
    let mut random = Random(1);
    for round in 0..400 {
        let time = 10_f64.powf(random.between(-4.0, 3.0)) as f32;
        let nanoseconds = 10_f64.powf(random.between(5.0, 7.8)) as u32;
        let mut filter = filter(GyroRange::ALL[round % 4], nanoseconds, time);
        let bias = random.vector(6e8).map(|parts| parts as i32);
        filter.set_bias(Bias::from_parts_of_counts(bias));
        let (spin, force) = (random.between(0.0, 32767.0), random.between(0.0, 32767.0));
        for _ in 0..10_000 {
            let gyro = random.vector(spin).map(|counts| counts as i16);
            let accel = random.vector(force).map(|counts| counts as i16);
            filter.update(&sample(gyro, accel));
            assert_unit(&filter, (time, nanoseconds, gyro, accel));
        }
    }
}

#[test]
fn free_fall_corrects_nothing() {
    let mut filter = filter(GyroRange::Dps2000, 1_000_000, 0.0);
    filter.reset(Force::from_counts([9000, -3000, 7000]));
    let before = orientation(&filter);
    for _ in 0..1000 {
        filter.update(&sample([0; 3], [0; 3]));
    }
    assert!(degrees_apart(before, orientation(&filter)) < 1e-6);
}

/// A quarter turn about each axis by the gyro alone, at any period up to the longest.
#[test]
fn the_gyro_turns_by_rate_times_time() {
    for range in GyroRange::ALL {
        for nanoseconds in [125_000, 1_000_000, 4_000_000, 6_700_000] {
            for axis in 0..3 {
                let mut gyro = [0; 3];
                gyro[axis] = 8192;
                let mut filter = filter(range, nanoseconds, f32::INFINITY);
                let samples = 1000;
                for _ in 0..samples {
                    filter.update(&sample(gyro, [0; 3]));
                }
                let angle = range.max_dps().to_radians() / 4.0
                    * f64::from(nanoseconds)
                    * 1e-9
                    * f64::from(samples);
                let mut expected = Vector3::zeros();
                expected[axis] = angle;
                let expected = UnitQuaternion::from_scaled_axis(expected);
                let off = degrees_apart(expected, orientation(&filter));
                assert!(
                    off < 1e-3,
                    "{range:?} {nanoseconds} {axis}: {off:e} degrees"
                );
            }
        }
    }
}

/// A bias in physical units takes off the counts it stands for.
#[test]
fn a_bias_is_taken_off() {
    for range in GyroRange::ALL {
        let mut filter = filter(range, 1_000_000, f32::INFINITY);
        let dps = range.max_dps() as f32 / 64.0;
        let bias = GyroBias::new(AngularRate::from_dps(Vector3::new(dps, -dps, 2.0 * dps)));
        filter.set_bias(Bias::new(bias, range));
        for _ in 0..1000 {
            filter.update(&sample([512, -512, 1024], [0; 3]));
        }
        let off = degrees_apart(UnitQuaternion::identity(), orientation(&filter));
        assert!(off < 1e-4, "{range:?}: {off:e} degrees");
    }
}

#[test]
fn it_goes_on_from_any_orientation() {
    let mut random = Random(19);
    let mut filter = filter(GyroRange::Dps2000, 1_000_000, 7.6);
    for _ in 0..10_000 {
        let set = UnitQuaternion::from_scaled_axis(Vector3::from(random.vector(3.0)));
        let length = random.between(0.51, 1.99);
        let Quaternion { coords } = set.into_inner() * length;
        let bits = |part: f64| (part * f64::from(1 << 30)) as i32;
        assert!(filter.set([coords.w, coords.x, coords.y, coords.z].map(bits)));
        assert_unit(&filter, set);
        assert!(degrees_apart(set, orientation(&filter)) < 2e-6);
    }
    let before = filter.bits();
    for nonsense in [[0; 4], [1, 2, 3, 4], [i32::MIN; 4], [1 << 28, 0, 0, 0]] {
        assert!(!filter.set(nonsense));
        assert_eq!(filter.bits(), before);
    }
}
