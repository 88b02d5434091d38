//! Section 4.1, eq. 7: the matrix M in both ways.

use crate::reference::*;
use nalgebra::RealField;
use vrduino::units::Angle;
use vrduino::virtual_gyro::{Directions, matrix};

/// An attitude, its dip, and both matrices.
fn both<T: RealField + Copy>(random: &mut Random) -> (Matrix, [Matrix; 2]) {
    let attitude = r(random.attitude());
    let dip = random.between(-1.2, 1.2);
    let seen = directions::<T>(&attitude, dip);
    let angle = Angle::from_rad(nalgebra::convert::<f64, T>(dip));
    let found = [
        matrix::from_gravity(&seen),
        matrix::from_field(&seen, angle),
    ];
    (attitude, found.map(|m| rows(&m)))
}

fn worst<T: RealField + Copy>() -> f64 {
    let mut random = Random(1);
    (0..2_000_000)
        .flat_map(|_| {
            let (attitude, found) = both::<T>(&mut random);
            found.map(|m| largest_difference(&m, &attitude))
        })
        .fold(0.0, larger)
}

#[test]
fn both_ways_to_the_matrix_give_r_in_double_precision() {
    let worst = worst::<f64>();
    assert!(worst < 1e-9, "{worst:e}");
}

#[test]
fn both_ways_to_the_matrix_give_r_in_single_precision() {
    let worst = worst::<f32>();
    assert!(worst < 1e-5, "{worst:e}");
}

#[test]
fn the_matrix_turns_each_vector_of_the_reference_into_that_of_the_device() {
    let mut random = Random(2);
    for _ in 0..100_000 {
        let attitude = r(random.attitude());
        let dip = random.between(-1.4, 1.4);
        let seen = directions::<f64>(&attitude, dip);
        let m = rows(&matrix::from_gravity(&seen));
        let (s, c) = dip.sin_cos();
        let cross = |a: nalgebra::Vector3<f64>, b| array(a.cross(&b));
        let pairs = [
            (array(seen.gravity()), [0.0, 0.0, 1.0]),
            (array(seen.magnetic()), [c, 0.0, s]),
            (array(seen.east()), [0.0, 1.0, 0.0]),
            (cross(seen.magnetic(), seen.east()), [-s, 0.0, c]), // T_B
            (cross(seen.gravity(), seen.east()), [-1.0, 0.0, 0.0]), // T_g
        ];
        for (device, reference) in pairs {
            assert!(apart(apply(&m, reference), device) < 1e-12);
        }
        assert!((seen.dip().rad() - dip).abs() < 1e-12);
    }
}

#[test]
fn with_a_wrong_dip_the_two_ways_differ_by_its_error() {
    let attitude = r([0.3, -0.4, 1.1]);
    let seen = directions::<f64>(&attitude, 1.1);
    let wrong = Angle::from_rad(1.1 + 3.0_f64.to_radians());
    let by_gravity = rows(&matrix::from_gravity(&seen));
    let by_field = rows(&matrix::from_field(&seen, wrong));
    assert!((degrees_between(&by_gravity, &by_field) - 3.0).abs() < 1e-9);
    // Gravity is vertical in the first only.
    let down = [0.0, 0.0, 1.0];
    assert!(apart(apply(&by_gravity, down), array(seen.gravity())) < 1e-12);
    assert!(apart(apply(&by_field, down), array(seen.gravity())) > 0.03);
    // The measured dip needs no table of the earth's field.
    let by_measured = rows(&matrix::from_field(&seen, seen.dip()));
    assert!(largest_difference(&by_gravity, &by_measured) < 1e-12);
}

#[test]
fn the_matrix_stays_a_rotation_next_to_a_magnetic_pole() {
    let mut random = Random(3);
    for _ in 0..200_000 {
        let attitude = r(random.attitude());
        let from_pole = 10_f64.powf(random.between(-7.5, -1.0));
        let seen: Directions<f64> = directions(&attitude, std::f64::consts::FRAC_PI_2 - from_pole);
        for m in [
            matrix::from_gravity(&seen),
            matrix::from_field(&seen, seen.dip()),
        ] {
            let m = rows(&m);
            let identity = product(&m, &transpose(&m));
            let one = r([0.0; 3]);
            assert!(largest_difference(&identity, &one) < 1e-12, "{from_pole:e}");
        }
    }
}
