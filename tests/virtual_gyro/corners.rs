//! The whole way from readings to rate (figures 3 and 6), and the input that is none.

use crate::reference::*;
use nalgebra::{RealField, Vector3, convert};
use std::f64::consts::{FRAC_PI_2, PI};
use vrduino::units::{MagneticField, Seconds, SpecificForce};
use vrduino::virtual_gyro::butterworth::CutOff;
use vrduino::virtual_gyro::{
    Estimate, Fields, GimbalLock, GravityExtraction, Method, NoAttitude, NoEstimate, Settings,
    VirtualGyro,
};

const PERIOD: f64 = 0.01;
const DIP: f64 = 1.1;
const METHODS: [Method; 3] = [
    Method::Angles(GimbalLock::Resolve),
    Method::Angles(GimbalLock::Keep),
    Method::Matrix,
];

type Gyro<T> = VirtualGyro<T, 3, 3>;

fn gyro<T: RealField + Copy>(method: Method, period: f64) -> Gyro<T> {
    VirtualGyro::new(Settings {
        sample_period: Seconds(convert(period)),
        method,
    })
}

fn feed<T: RealField + Copy>(
    gyro: &mut Gyro<T>,
    attitude: &Matrix,
) -> Result<Estimate<T>, NoEstimate> {
    let fields = seen(attitude, DIP);
    gyro.update(
        SpecificForce::from_m_per_s2(-fields.gravity),
        Some(MagneticField::from_microtesla(fields.magnetic)),
    )
}

#[test]
fn a_resting_device_has_its_attitude_and_no_rate_by_either_method() {
    let mut random = Random(1);
    for _ in 0..500 {
        let attitude = r(random.attitude());
        for method in METHODS {
            let mut gyro = gyro::<f64>(method, PERIOD);
            for _ in 0..4 {
                assert_eq!(feed(&mut gyro, &attitude), Err(NoEstimate::Filling));
            }
            assert_eq!(feed(&mut gyro, &attitude).unwrap().velocity, None);
            let found = feed(&mut gyro, &attitude).unwrap();
            let q = sandwich(scalar_last(&found.orientation));
            assert!(largest_difference(&transpose(&q), &attitude) < 1e-9);
            assert!(largest_difference(&r(rad(&found.angles)), &attitude) < 1e-9);
            let velocity = found.velocity.unwrap();
            assert!(velocity.device.rad_per_s().norm() < 1e-9);
        }
    }
}

/// A steady turn about the vertical: gravity stays, so that the filters only delay.
fn heading_turn<T: RealField + Copy>(method: Method, tilt: [f64; 2]) -> Vec<Estimate<T>> {
    let mut gyro = gyro::<T>(method, PERIOD);
    let [phi, theta] = tilt;
    (0..1000)
        .filter_map(|k| {
            let psi = 2.0 * PERIOD * f64::from(k); // 2 rad/s, through the ±180° seam
            feed(&mut gyro, &r([phi, theta, psi])).ok()
        })
        .collect()
}

#[test]
fn a_steady_turn_about_the_vertical_is_its_rate_in_both_frames_and_by_both_methods() {
    for tilt in [[0.0, 0.0], [0.3, -0.4], [PI, 0.0], [-2.0, 1.2], [0.0, 1.5]] {
        for method in METHODS {
            let found = heading_turn::<f64>(method, tilt);
            assert_eq!(found.len(), 996);
            // In phase and settled. The vertical part of B is settled from the start.
            for estimate in &found[400..] {
                let velocity = estimate.velocity.unwrap();
                let reference = array(velocity.reference.rad_per_s());
                assert!(apart(reference, [0.0, 0.0, 2.0]) < 1e-6, "{reference:?}");
                let down = apply(&r([tilt[0], tilt[1], 0.0]), [0.0, 0.0, 2.0]);
                assert!(apart(array(velocity.device.rad_per_s()), down) < 1e-6);
            }
        }
    }
}

#[test]
fn figure_8_of_a_tumbling_device_the_rate_is_that_of_a_gyro_fixed_to_it() {
    // Body rates as a gyro would read them, integrated in small steps in matrices; windows of one
    // and F_c = F_e/4, where the low-pass is the mean of two samples: half a sample late. The
    // tumble passes every attitude.
    let step = 1e-3;
    let rate = |t: f64| {
        [
            2.0 * (0.7 * t).sin(),
            1.5 + (1.3 * t).cos(),
            (0.4 * t).sin() - 1.0,
        ]
    };
    for method in [METHODS[0], METHODS[2]] {
        let cut_off = CutOff::new(0.25).unwrap();
        let mut gyro = VirtualGyro::<f64, 1, 1>::with_extraction(
            Settings {
                sample_period: Seconds(step),
                method,
            },
            GravityExtraction::with_cut_off(cut_off),
        );
        let mut a = transpose(&r([0.3, -0.4, 1.1])); // device to reference
        for k in 0..60_000 {
            let fields = seen(&transpose(&a), DIP);
            let found = gyro.update(
                SpecificForce::from_m_per_s2(-fields.gravity),
                Some(MagneticField::from_microtesla(fields.magnetic)),
            );
            // From the middle of one step to the middle of the next.
            let now = rate(step * (f64::from(k) - 1.0));
            if k >= 10 {
                let velocity = found.unwrap().velocity.unwrap();
                let device = array(velocity.device.rad_per_s());
                assert!(apart(device, now) < 1e-5, "{k}: {device:?}, {now:?}");
                let reference = array(velocity.reference.rad_per_s());
                assert!(apart(reference, apply(&a, device)) < 1e-2);
            }
            let w = rate(step * (f64::from(k) + 0.5));
            let size = w.iter().map(|c| c * c).sum::<f64>().sqrt();
            a = product(&a, &about(w.map(|c| c / size), size * step));
        }
    }
}

#[test]
fn while_nose_up_keeping_the_angles_misses_the_turn_that_resolving_and_the_matrix_see() {
    let rate = |method| {
        let found = heading_turn::<f64>(method, [0.3, FRAC_PI_2]);
        let velocity = found[600].velocity.unwrap();
        velocity.reference.rad_per_s().z
    };
    assert!((rate(Method::Angles(GimbalLock::Resolve)) - 2.0).abs() < 1e-6);
    assert!((rate(Method::Matrix) - 2.0).abs() < 1e-6);
    assert_eq!(rate(Method::Angles(GimbalLock::Keep)), 0.0);
}

#[test]
fn the_sign_of_the_quaternion_never_jumps() {
    for method in METHODS {
        let found = heading_turn::<f32>(method, [0.3, -0.4]);
        for pair in found.windows(2) {
            let [a, b] = [&pair[0], &pair[1]].map(|e| e.orientation.coords);
            assert!(a.dot(&b) > 0.9);
        }
    }
}

fn fields(gravity: Vector, magnetic: Vector) -> Fields<f64> {
    Fields {
        gravity: vector(gravity),
        magnetic: vector(magnetic),
    }
}

#[test]
fn fields_that_tell_no_attitude_say_why() {
    let (down, north) = ([0.0, 0.0, 9.81], [20.0, 0.0, 0.0]);
    let nothing = [0.0; 3];
    let why = |g, b| fields(g, b).directions().err();
    assert_eq!(why(down, north), None);
    assert_eq!(why(nothing, north), Some(NoAttitude::FreeFall));
    // Below 60 mg it falls, above it does not.
    let pulled = |g: f64| [0.0, 0.6, 0.8].map(|c| c * g * 9.81);
    assert_eq!(why(pulled(0.0599), north), Some(NoAttitude::FreeFall));
    assert_eq!(why(pulled(0.0601), north), None);
    assert_eq!(why(down, nothing), Some(NoAttitude::NoMagneticField));
    for parallel in [1.0, -3.0] {
        let field = down.map(|c| c * parallel);
        assert_eq!(why(down, field), Some(NoAttitude::FieldsParallel));
        assert_eq!(
            why([1.0, 2.0, 3.0], [1.0, 2.0, 3.0].map(|c| c * parallel)),
            Some(NoAttitude::FieldsParallel)
        );
    }
    // As close to vertical as half the digits tell.
    let tilted = |angle: f64| [48.0 * angle.sin(), 0.0, -48.0 * angle.cos()];
    assert_eq!(why(down, tilted(1.4e-8)), Some(NoAttitude::FieldsParallel));
    assert_eq!(why(down, tilted(1.6e-8)), None);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(why([bad, 0.0, 9.81], north), Some(NoAttitude::NotFinite));
        assert_eq!(why(down, [0.0, bad, 0.0]), Some(NoAttitude::NotFinite));
    }
    // Sizes play no part, down to the smallest numbers and up to the largest.
    for size in [1e-300, 1e-10, 1e300] {
        assert_eq!(why(down, north.map(|c| c * size)), None);
    }
    for reason in [
        NoAttitude::NotFinite,
        NoAttitude::FreeFall,
        NoAttitude::NoMagneticField,
        NoAttitude::FieldsParallel,
    ] {
        let said = NoEstimate::Attitude(reason).to_string();
        assert_eq!(said, reason.to_string());
        assert!(said.contains(": "), "what is wrong and what to do: {said}");
    }
}

/// Numbers of every size and kind.
fn anything(random: &mut Random) -> f64 {
    match (random.unit() * 16.0) as u32 {
        0 => f64::NAN,
        1 => f64::INFINITY,
        2 => -f64::INFINITY,
        3 => 0.0,
        4 => f64::MAX,
        5 => f64::MIN_POSITIVE,
        6 => 5e-324,
        7 => random.between(-1.0, 1.0) * 1e38,
        8 => 10_f64.powf(random.between(-50.0, 50.0)),
        _ => random.between(-20.0, 20.0),
    }
}

fn survives<T: RealField + Copy>() {
    let mut random = Random(3);
    let mut found = 0;
    for round in 0..600 {
        let method = METHODS[round % 3];
        let period = [PERIOD, 0.0, -1.0, f64::NAN, f64::INFINITY, 1e30, 1e-30][round % 7];
        let mut gyro = gyro::<T>(method, period);
        for _ in 0..1000 {
            let mut any = || convert::<f64, T>(anything(&mut random));
            let force = SpecificForce::from_m_per_s2(Vector3::new(any(), any(), any()));
            let field = MagneticField::from_microtesla(Vector3::new(any(), any(), any()));
            let field = (random.unit() < 0.9).then_some(field);
            let Ok(estimate) = gyro.update(force, field) else {
                continue;
            };
            found += 1;
            let length: f64 = scalar_last(&estimate.orientation)
                .iter()
                .map(|c| c * c)
                .sum();
            assert!((length - 1.0).abs() < 1e-6, "{length}");
            let [phi, theta, psi] = rad(&estimate.angles);
            let (whole, quarter) = (PI + 1e-6, FRAC_PI_2 + 1e-6);
            assert!(phi.abs() <= whole && theta.abs() <= quarter && psi.abs() <= whole);
            if let Some(velocity) = estimate.velocity {
                let both = [velocity.device, velocity.reference];
                assert!(
                    both.iter()
                        .all(|rate| rate.rad_per_s().iter().all(|c| c.is_finite()))
                );
            }
        }
    }
    assert!(found > 3000, "{found}");
}

#[test]
fn whatever_is_fed_the_result_is_finite_and_of_unit_length_or_an_error_in_double_precision() {
    survives::<f64>();
}

#[test]
fn whatever_is_fed_the_result_is_finite_and_of_unit_length_or_an_error_in_single_precision() {
    survives::<f32>();
}

#[test]
fn after_samples_without_attitude_the_velocity_is_the_mean_since_the_last() {
    for method in METHODS {
        // Windows of one: only the low-pass is between the fields and the attitude.
        let mut gyro = VirtualGyro::<f64, 1, 1>::new(Settings {
            sample_period: Seconds(PERIOD),
            method,
        });
        let level = seen::<f64>(&r([0.0; 3]), DIP);
        let force = SpecificForce::from_m_per_s2(-level.gravity);
        let field = MagneticField::from_microtesla;
        let before = gyro.update(force, Some(field(level.magnetic))).unwrap();
        for _ in 0..9 {
            let absent = gyro.update(force, None);
            assert_eq!(
                absent,
                Err(NoEstimate::Attitude(NoAttitude::NoMagneticField))
            );
            let broken = gyro.update(force, Some(field(Vector3::new(f64::NAN, 0.0, 0.0))));
            assert_eq!(broken, Err(NoEstimate::Attitude(NoAttitude::NotFinite)));
        }
        let turned = level.magnetic + Vector3::y() * 20.0;
        let turned = gyro.update(force, Some(field(turned))).unwrap();
        let [before, after] = [before, turned].map(|e| sandwich(scalar_last(&e.orientation)));
        let degrees = degrees_between(&before, &after);
        assert!(degrees > 1.0, "{degrees}");
        let rate = turned.velocity.unwrap().device.dps().norm();
        assert!((rate * 19.0 * PERIOD - degrees).abs() < 1e-9);
    }
}

#[test]
fn a_sample_period_that_is_none_gives_attitudes_without_a_rate() {
    for period in [0.0, -PERIOD, f64::NAN, f64::INFINITY] {
        for method in METHODS {
            let mut gyro = gyro::<f64>(method, period);
            for k in 0..50 {
                let found = feed(&mut gyro, &r([0.1, 0.2, 0.01 * f64::from(k)]));
                assert!(found.is_err() || found.unwrap().velocity.is_none());
            }
        }
    }
}
