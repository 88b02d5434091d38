//! Sections 3.5, 3.6 and 4.3: quaternions, scalar last.

use crate::reference::*;
use nalgebra::{Quaternion, RealField, Unit, UnitQuaternion, Vector4, convert};
use std::f64::consts::{FRAC_PI_2, PI};
use vrduino::virtual_gyro::attitude_quaternion::{from_angles, from_matrix, to_angles};
use vrduino::virtual_gyro::{GimbalLock, TaitBryan, matrix};

fn quaternion(q: [f64; 4]) -> Quaternion<f64> {
    Quaternion::from_vector(Vector4::from(q))
}

fn of<T: RealField + Copy>(angles: Vector) -> UnitQuaternion<T> {
    let [phi, theta, psi] = angles.map(convert::<f64, T>);
    from_angles(&TaitBryan::from_rad(phi, theta, psi))
}

#[test]
fn product_inverse_and_rotation_are_those_of_eq_5_and_6() {
    let mut random = Random(1);
    for _ in 0..100_000 {
        let [a, b] = [(); 2].map(|()| [(); 4].map(|()| random.between(-2.0, 2.0)));
        let expected = hamilton(a, b);
        let found = quaternion(a) * quaternion(b);
        for (found, expected) in found.coords.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12);
        }
        // Not commutative, and the conjugate is the inverse at unit length only.
        assert!((quaternion(b) * quaternion(a) - found).norm() > 1e-9);
        let n = quaternion(a).norm_squared();
        let by_conjugate = quaternion(a) * quaternion(a).conjugate();
        assert!((by_conjugate - Quaternion::new(n, 0.0, 0.0, 0.0)).norm() < 1e-12);
        let unit = Unit::new_normalize(quaternion(a));
        let v = random.vector(5.0);
        let turned = array(unit * vector::<f64>(v));
        assert!(apart(turned, apply(&sandwich(scalar_last(&unit)), v)) < 1e-12);
    }
}

#[test]
fn euler_rodrigues_parameters_turn_about_the_axis_and_compose_from_the_right() {
    let mut random = Random(2);
    let mut turn = || {
        let v = random.vector(1.0);
        let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        let (axis, angle) = (v.map(|c| c / length), random.between(-PI, PI));
        let (s, c) = (angle / 2.0).sin_cos();
        (
            [axis[0] * s, axis[1] * s, axis[2] * s, c],
            about(axis, angle),
        )
    };
    for _ in 0..100_000 {
        let ((alpha, a), (beta, b)) = (turn(), turn());
        assert!(largest_difference(&sandwich(alpha), &a) < 1e-12);
        // q_α q_β turns by β first, then by α.
        assert!(largest_difference(&sandwich(hamilton(alpha, beta)), &product(&a, &b)) < 1e-12);
    }
}

#[test]
fn the_quaternion_of_the_angles_is_device_to_reference() {
    let mut random = Random(3);
    for _ in 0..2_000_000 {
        let angles = random.attitude();
        let found = sandwich(scalar_last(&of::<f64>(angles)));
        assert!(largest_difference(&found, &transpose(&r(angles))) < 1e-12);
    }
}

#[test]
fn the_printed_order_is_neither_this_attitude_nor_its_inverse() {
    let angles: Vector = [0.3, -0.4, 1.1];
    let [phi, theta, psi] = angles.map(|angle: f64| (angle / 2.0).sin_cos());
    let printed = hamilton(
        hamilton([phi.0, 0.0, 0.0, phi.1], [0.0, theta.0, 0.0, theta.1]),
        [0.0, 0.0, psi.0, psi.1],
    );
    let m = sandwich(printed);
    assert!((degrees_between(&m, &r(angles)) - 133.0).abs() < 0.5);
    assert!((degrees_between(&m, &transpose(&r(angles))) - 30.0).abs() < 0.5);
    assert!(apart(printed_angles(printed), [-0.22, -0.45, 1.09]) < 5e-3);
}

/// Section 4.3 as printed, arctan2(a/b) read as atan2(a, b).
fn printed_angles([q1, q2, q3, q4]: [f64; 4]) -> Vector {
    [
        (2.0 * (q1 * q4 + q2 * q3)).atan2(1.0 - 2.0 * (q1 * q1 + q2 * q2)),
        (2.0 * (q2 * q4 - q3 * q1)).asin(),
        (2.0 * (q3 * q4 + q1 * q2)).atan2(1.0 - 2.0 * (q2 * q2 + q3 * q3)),
    ]
}

#[test]
fn the_angles_are_those_of_the_printed_formulas_away_from_the_singularities() {
    let mut random = Random(4);
    for _ in 0..2_000_000 {
        let angles = [
            random.between(-PI, PI),
            random.between(-1.5, 1.5),
            random.between(-PI, PI),
        ];
        let q = of::<f64>(angles);
        for q in [q, negated(&q)] {
            let found = rad(&to_angles(&q, None));
            assert!(apart(found, printed_angles(scalar_last(&q))) < 1e-9);
            assert!(apart(found, angles) < 1e-9);
        }
    }
}

fn worst<T: RealField + Copy>() -> f64 {
    let mut random = Random(5);
    (0..2_000_000)
        .map(|_| {
            let angles = random.attitude();
            let found = rad(&to_angles(&of::<T>(angles), None));
            largest_difference(&r(found), &r(angles))
        })
        .fold(0.0, larger)
}

#[test]
fn the_angles_of_a_quaternion_rebuild_it_everywhere() {
    let worst_double = worst::<f64>();
    assert!(worst_double < 1e-9, "{worst_double:e}");
    let worst_single = worst::<f32>();
    assert!(worst_single < 1e-5, "{worst_single:e}");
}

#[test]
fn a_tilt_of_a_ten_thousandth_is_resolved_by_the_second_method_in_single_precision() {
    for (phi, theta) in [(1e-4, 0.0), (0.0, 1e-4), (-1e-4, 1e-4), (3e-4, -1e-4)] {
        let seen = directions::<f32>(&r([phi, theta, 0.7]), 1.1);
        let q = from_matrix(&matrix::from_gravity(&seen)).unwrap();
        let found = rad(&to_angles(&q, None));
        assert!(apart(found, [phi, theta, 0.7]) < 5e-7, "{found:?}");
    }
}

#[test]
fn the_printed_arc_sine_fails_next_to_the_singularities() {
    // Rounding takes its argument beyond 1, or loses half of the digits.
    let (mut undefined, mut off) = (0, 0.0_f64);
    let mut random = Random(6);
    for _ in 0..100_000 {
        let theta = FRAC_PI_2 - random.between(0.0, 1e-7);
        let q = of::<f64>([random.between(-PI, PI), theta, random.between(-PI, PI)]);
        let [_, printed, _] = printed_angles(scalar_last(&q));
        let [_, found, _] = rad(&to_angles(&q, None));
        assert!((found - theta).abs() < 1e-14 * 10.0);
        if printed.is_nan() {
            undefined += 1;
        } else {
            off = off.max((printed - theta).abs());
        }
    }
    assert!(undefined > 0 && off > 1e-9, "{undefined}, {off:e}");
}

#[test]
fn at_the_singularities_the_roll_is_kept_and_the_yaw_follows() {
    let previous = TaitBryan::from_rad(0.7, 1.5, 0.4);
    for theta in [FRAC_PI_2, -FRAC_PI_2] {
        let q = of::<f64>([0.7, theta, -1.3]);
        assert!(apart(rad(&to_angles(&q, Some(previous))), [0.7, theta, -1.3]) < 1e-12);
        // Printed: “the previous value of θ is kept”. But θ is the one angle that is known.
        let [phi, _, psi] = printed_angles(scalar_last(&q));
        let printed = r([phi, 1.2, psi]);
        assert!(degrees_between(&printed, &r([0.7, theta, -1.3])) > 20.0);
    }
}

#[test]
fn both_methods_give_the_same_attitude() {
    let mut random = Random(7);
    for _ in 0..2_000_000 {
        let seen = directions::<f64>(&r(random.attitude()), random.between(-1.3, 1.3));
        let angles = TaitBryan::from_directions(&seen, GimbalLock::Resolve, None);
        let first = sandwich(scalar_last(&from_angles(&angles)));
        let second = from_matrix(&matrix::from_gravity(&seen)).unwrap();
        assert!(largest_difference(&first, &sandwich(scalar_last(&second))) < 1e-9);
        let angles = rad(&to_angles(&second, None));
        assert!(largest_difference(&transpose(&r(angles)), &first) < 1e-9);
    }
}

#[test]
fn what_is_no_angle_and_no_rotation_counts_as_none() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let angles = TaitBryan::from_rad(0.3, bad, -1.1);
        let without = TaitBryan::from_rad(0.3, 0.0, -1.1);
        assert_eq!(from_angles(&angles), from_angles(&without));
        assert_eq!(angles.matrix(), without.matrix());
        let none = UnitQuaternion::new_unchecked(quaternion([0.1, bad, 0.0, 1.0]));
        assert_eq!(rad(&to_angles(&none, None)), [0.0; 3]);
    }
    let none = UnitQuaternion::new_unchecked(quaternion([0.0; 4]));
    assert_eq!(rad(&to_angles(&none, None)), [0.0; 3]);
    for length in [1e-200, 1e200] {
        let q = of::<f64>([0.3, -0.4, 1.1]);
        let other = UnitQuaternion::new_unchecked(q.into_inner() * length);
        assert!(apart(rad(&to_angles(&other, None)), [0.3, -0.4, 1.1]) < 1e-12);
    }
}
