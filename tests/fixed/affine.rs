//! Corrections in fixed point beside those in double precision.

use crate::random::Random;
use vrduino::fixed::affine::{Accelerometer, Magnetometer};
use vrduino::fixed::multiply::Portable;
use vrduino::nalgebra::{Matrix3, Vector3};
use vrduino::sensor::magnetometer::to_body;
use vrduino::sensor::measurement::Calibration;
use vrduino::sensor::{AccelRange, GyroRange, Ranges, RawSample};
use vrduino::units::{MagneticField, SpecificForce};

fn matrix(random: &mut Random, about: f64, size: f64) -> Matrix3<f64> {
    Matrix3::identity() * about + Matrix3::from_fn(|_, _| random.between(-size, size))
}

fn counts(random: &mut Random) -> [i16; 3] {
    random.vector(32_768.0).map(|count| count as i16)
}

#[test]
fn a_force_is_corrected_as_in_double_precision() {
    let mut random = Random(21);
    for range in AccelRange::ALL {
        let g = range.max_g();
        for _ in 0..200 {
            let matrix = matrix(&mut random, 1.0, 0.08);
            let offset = Vector3::from(random.vector(0.2 * g)) * 9.81;
            let calibration = Calibration::new(matrix, SpecificForce::from_m_per_s2(offset));
            let narrow = Calibration::new(
                matrix.cast::<f32>(),
                SpecificForce::from_m_per_s2(offset.cast::<f32>()),
            );
            let fixed = Accelerometer::<Portable>::new(&narrow, range).expect("it is near one");
            for _ in 0..100 {
                let raw = RawSample {
                    accel: counts(&mut random),
                    ..RawSample::default()
                };
                let ranges = Ranges {
                    gyro: GyroRange::Dps2000,
                    accel: range,
                };
                let expected = calibration.corrected(ranges.sample(&raw).force).g();
                let parts = fixed.force(raw.accel).parts_of_counts();
                for axis in 0..3 {
                    let most = expected[axis].clamp(-g, g);
                    let found = f64::from(parts[axis]) / f64::from(1 << 30) * g;
                    // A hundredth of a count: what single precision leaves of matrix and offset.
                    assert!(
                        (found - most).abs() < 0.04 * g / 32_768.0,
                        "{raw:?} {found} {most}"
                    );
                }
            }
        }
    }
}

#[test]
fn no_correction_changes_no_count() {
    let none = Calibration::new(
        Matrix3::identity(),
        SpecificForce::from_m_per_s2(Vector3::zeros()),
    );
    let fixed = Accelerometer::<Portable>::new(&none, AccelRange::G16).expect("it is one");
    for counts in [[0, 1, -1], [i16::MAX, i16::MIN, 2048]] {
        let expected = counts.map(|count| i32::from(count) << 15);
        assert_eq!(fixed.force(counts).parts_of_counts(), expected);
    }
}

#[test]
fn a_field_is_corrected_as_in_double_precision() {
    let mut random = Random(22);
    for _ in 0..500 {
        let matrix = matrix(&mut random, 1.0, 0.2);
        let offset = Vector3::from(random.vector(300.0));
        let sensitivity = Vector3::from([(); 3].map(|()| 0.15 * random.between(0.6, 1.4)));
        let narrow = Calibration::new(
            matrix.cast::<f32>(),
            MagneticField::from_microtesla(offset.cast::<f32>()),
        );
        let fixed = Magnetometer::<Portable>::new(&narrow, sensitivity.cast::<f32>())
            .expect("a count is a fraction of a microtesla");
        for _ in 0..100 {
            let counts = counts(&mut random);
            let own = Vector3::from(counts.map(f64::from)).component_mul(&sensitivity);
            let expected = matrix * to_body(own) + offset;
            let parts = fixed.field(counts).parts_of_microtesla();
            for axis in 0..3 {
                let found = f64::from(parts[axis]) / 32_768.0;
                assert!((found - expected[axis]).abs() < 2e-3, "{found} {expected}");
            }
        }
    }
}

#[test]
fn what_would_not_fit_is_refused() {
    let identity = Matrix3::<f32>::identity();
    let force = |part: f32| SpecificForce::from_m_per_s2(Vector3::repeat(part));
    let accelerometer = |matrix: Matrix3<f32>, offset: f32| {
        Accelerometer::<Portable>::new(&Calibration::new(matrix, force(offset)), AccelRange::G2)
    };
    assert!(accelerometer(identity, 0.0).is_some());
    assert!(accelerometer(identity * 2.0, 0.0).is_none());
    assert!(accelerometer(identity * f32::NAN, 0.0).is_none());
    assert!(accelerometer(identity, 9.81).is_none());
    assert!(accelerometer(identity, f32::INFINITY).is_none());
    let field = |part: f32| MagneticField::from_microtesla(Vector3::repeat(part));
    let magnetometer = |sensitivity: f32, offset: f32| {
        let calibration = Calibration::new(identity, field(offset));
        Magnetometer::<Portable>::new(&calibration, Vector3::repeat(sensitivity))
    };
    assert!(magnetometer(0.15, 100.0).is_some());
    assert!(magnetometer(0.6, 0.0).is_none());
    assert!(magnetometer(f32::NAN, 0.0).is_none());
    assert!(magnetometer(0.15, 20_000.0).is_none());
}
