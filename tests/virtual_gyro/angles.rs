//! Sections 3.1, 3.3 and 3.4.

use crate::reference::*;
use nalgebra::RealField;
use std::f64::consts::{FRAC_PI_2, PI};
use vrduino::units::Angle;
use vrduino::virtual_gyro::{Earth, GimbalLock, TaitBryan};

const DIP: f64 = 1.1;

fn resolved<T: RealField + Copy>(attitude: &Matrix, dip: f64) -> TaitBryan<T> {
    TaitBryan::from_directions(&directions(attitude, dip), GimbalLock::Resolve, None)
}

#[test]
fn r_is_the_product_of_the_printed_matrices() {
    let mut random = Random(1);
    for _ in 0..100_000 {
        let [phi, theta, psi] = random.attitude();
        let angles = TaitBryan::from_rad(phi, theta, psi);
        assert!(largest_difference(&rows(&angles.matrix()), &r([phi, theta, psi])) < 1e-15 * 10.0);
    }
}

#[test]
fn the_fields_in_the_device_frame_are_the_turned_fields_of_the_earth() {
    let mut random = Random(2);
    for _ in 0..100_000 {
        let angles = random.attitude();
        let dip = random.between(-1.5, 1.5);
        let earth = Earth {
            gravity: 9.81,
            field: 48.0,
            dip: Angle::from_rad(dip),
        };
        let [phi, theta, psi] = angles;
        let here = earth.in_device(&TaitBryan::from_rad(phi, theta, psi).matrix());
        let expected = seen::<f64>(&r(angles), dip);
        assert!((here.gravity - expected.gravity).norm() < 1e-13);
        assert!((here.magnetic - expected.magnetic).norm() < 1e-13);
        // Eq. 2: gravity does not see ψ.
        let without = apply(&product(&rx(phi), &ry(theta)), [0.0, 0.0, 9.81]);
        assert!(apart(array(here.gravity), without) < 1e-13);
    }
}

#[test]
fn eq_3_and_4_give_back_the_angles() {
    let mut random = Random(3);
    for _ in 0..2_000_000 {
        let angles = [
            random.between(-PI, PI),
            random.between(-1.5, 1.5),
            random.between(-PI, PI),
        ];
        let dip = random.between(-1.4, 1.4);
        assert!(apart(rad(&resolved::<f64>(&r(angles), dip)), angles) < 1e-9);
    }
}

fn worst<T: RealField + Copy>() -> f64 {
    let mut random = Random(4);
    (0..2_000_000)
        .map(|_| {
            let attitude = r(random.attitude());
            let dip = random.between(-1.2, 1.2);
            largest_difference(&r(rad(&resolved::<T>(&attitude, dip))), &attitude)
        })
        .fold(0.0, larger)
}

#[test]
fn the_angles_rebuild_every_attitude_in_double_precision() {
    let worst = worst::<f64>();
    assert!(worst < 1e-9, "{worst:e}");
}

#[test]
fn the_angles_rebuild_every_attitude_in_single_precision() {
    let worst = worst::<f32>();
    assert!(worst < 1e-5, "{worst:e}");
}

#[test]
fn a_tilt_of_a_ten_thousandth_is_resolved_in_single_precision() {
    for (phi, theta) in [(1e-4, 0.0), (0.0, 1e-4), (-1e-4, 1e-4), (3e-4, -1e-4)] {
        let angles = rad(&resolved::<f32>(&r([phi, theta, 0.7]), DIP));
        assert!(apart(angles, [phi, theta, 0.7]) < 2e-7, "{angles:?}");
    }
}

#[test]
fn at_the_singularities_the_heading_is_continuous() {
    // The continuous solution, for every heading and not only for table 1's four.
    let mut random = Random(5);
    for _ in 0..100_000 {
        let (phi, psi) = (random.between(-PI, PI), random.between(-PI, PI));
        for (theta, sign) in [(FRAC_PI_2, -1.0), (-FRAC_PI_2, 1.0)] {
            let attitude = r([phi, theta, psi]);
            let [kept, found_theta, found_psi] = rad(&resolved::<f64>(&attitude, DIP));
            assert_eq!((kept, found_theta), (0.0, theta));
            let error = (sign * phi + psi) - (sign * kept + found_psi);
            assert!((error / 2.0).sin().abs() < 1e-12, "{error}");
        }
    }
    // The errata's figure: (.7, −π/2, .4) with δ = .9 has φ + ψ = 1.1.
    let [phi, _, psi] = rad(&resolved::<f64>(&r([0.7, -FRAC_PI_2, 0.4]), 0.9));
    assert!((phi + psi - 1.1).abs() < 1e-12);
}

#[test]
fn resolving_keeps_the_roll_and_finds_the_yaw() {
    let previous = TaitBryan::from_rad(0.7, 1.5, 0.4);
    for theta in [FRAC_PI_2, -FRAC_PI_2] {
        let attitude = r([0.7, theta, -1.3]);
        let found = TaitBryan::from_directions(
            &directions::<f64>(&attitude, DIP),
            GimbalLock::Resolve,
            Some(previous),
        );
        assert!(apart(rad(&found), [0.7, theta, -1.3]) < 1e-12);
    }
}

#[test]
fn keeping_the_previous_angles_loses_what_turns_meanwhile() {
    let previous = TaitBryan::from_rad(0.7, 1.5, 0.4);
    let attitude = r([0.7, FRAC_PI_2, -1.3]);
    let at = |lock, previous| {
        TaitBryan::from_directions(&directions::<f64>(&attitude, DIP), lock, previous)
    };
    let kept = at(GimbalLock::Keep, Some(previous));
    assert_eq!(kept, previous);
    let error = degrees_between(&r(rad(&kept)), &attitude);
    assert!(error > 90.0, "{error}");
    // With nothing to keep, and away from the singularity, the two strategies are one.
    assert_eq!(at(GimbalLock::Keep, None), at(GimbalLock::Resolve, None));
    let level = directions::<f64>(&r([0.1, 0.2, 0.3]), DIP);
    let found = TaitBryan::from_directions(&level, GimbalLock::Keep, Some(previous));
    assert!(apart(rad(&found), [0.1, 0.2, 0.3]) < 1e-12);
}

#[test]
fn the_arc_tangent_of_a_quotient_loses_half_the_circle() {
    // Eq. 3 is printed as arctan2(g_dy/g_dz), of one argument.
    let attitude = r([2.5, 0.2, 0.3]);
    let [_, y, z] = apply(&attitude, [0.0, 0.0, 1.0]);
    assert!(((y / z).atan() - 2.5).abs() > 3.0);
    assert!((rad(&resolved::<f64>(&attitude, DIP))[0] - 2.5).abs() < 1e-12);
}

#[test]
fn the_three_turns_are_about_the_axes_of_the_device() {
    // “In the reference frame”, section 3.1. The device's axes, seen from the reference frame,
    // are the columns of Rᵀ; turning it about z, then about its new y, then its new x gives R.
    // The same angles about the fixed axes in that order give something else.
    let [phi, theta, psi] = [0.3, -0.4, 1.1];
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let after_z = about(z, psi);
    let new_y = apply(&after_z, y);
    let after_y = product(&about(new_y, theta), &after_z);
    let new_x = apply(&after_y, x);
    let intrinsic = product(&about(new_x, phi), &after_y);
    assert!(largest_difference(&transpose(&intrinsic), &r([phi, theta, psi])) < 1e-15 * 10.0);
    let fixed = product(&about(x, phi), &product(&about(y, theta), &about(z, psi)));
    assert!(degrees_between(&transpose(&fixed), &r([phi, theta, psi])) > 20.0);
    let fixed = product(&about(z, psi), &product(&about(y, theta), &about(x, phi)));
    assert!(largest_difference(&transpose(&fixed), &r([phi, theta, psi])) < 1e-15 * 10.0);
}
