//! A step of the gyro is as exact as its angle is, however many times round it goes.

mod random;

use nalgebra::{RealField, Vector3, convert, try_convert};
use random::Random;
use vrduino::orientation::gyro;
use vrduino::units::{AngularRate, Seconds};

/// The largest difference, over steps of `size` rad, between a component of eq. 17 in T and in f64,
/// which is given the very rate that T was. A period of 1 s rounds nothing.
fn error<T: RealField + Copy>(random: &mut Random, size: f64) -> f64 {
    let mut largest = 0.0_f64;
    for _ in 0..20_000 {
        let rate = Vector3::from(random.vector(1.0)).normalize() * size;
        let rate = rate.map(|component| convert::<f64, T>(component));
        let q = gyro::step(AngularRate::from_rad_per_s(rate), Seconds(T::one()));
        let of = |value: T| -> f64 { try_convert(value).unwrap() };
        let rate = rate.map(of);
        let (sin, cos) = (rate.norm() / 2.0).sin_cos();
        let v = rate.normalize() * sin;
        for (found, right) in [q.w, q.i, q.j, q.k].into_iter().zip([cos, v.x, v.y, v.z]) {
            largest = largest.max((of(found) - right).abs());
        }
    }
    largest
}

#[test]
fn a_step_of_many_turns_is_as_exact_as_its_angle() {
    let mut random = Random(1);
    for size in [
        1e-3, 0.1, 1.0, 3.0, 6.2, 6.3, 12.0, 12.6, 20.0, 50.0, 1e2, 1e3, 1e4,
    ] {
        let (single, double) = (
            error::<f32>(&mut random, size),
            error::<f64>(&mut random, size),
        );
        eprintln!("{size} rad: {single:.1e} in f32, {double:.1e} in f64");
        // What half an angle of this size is rounded by.
        let rounding = |epsilon: f64| size / 2.0 * epsilon;
        assert!(
            single < f64::max(1e-5, rounding(f32::EPSILON.into())),
            "{size} rad: {single}"
        );
        assert!(double < 1e-9, "{size} rad: {double}");
    }
}
