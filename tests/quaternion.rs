//! The quaternion algebra is that of rotation matrices, and closed where the notes leave corners
//! open. As printed, eq. 34 and 36 stand here beside the library's.

mod matrices;

mod random;

mod rotations;

use nalgebra::{Matrix3, Quaternion, RealField, UnitQuaternion, Vector3, convert, try_convert};
use rotations::{
    Matrix, Random, angle_between, anything, apply, assert_is_a_rotation, components, larger,
    largest_difference, length, matrix, product, random_quaternion, rotation, unit_quaternion,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use vrduino::orientation::quaternion::{
    NotARotation, axis_angle, from_axis_angle, from_matrix, inverse, slerp, unit,
};
use vrduino::units::Angle;

const MANY: usize = 2_000_000;

fn quaternion(random: &mut Random, size: f64) -> Quaternion<f64> {
    let [w, x, y, z] = [(); 4].map(|()| random.between(-size, size));
    Quaternion::new(w, x, y, z)
}

fn vector<T: RealField + Copy>(v: [f64; 3]) -> Vector3<T> {
    Vector3::from(v.map(convert::<f64, T>))
}

fn nalgebra_matrix<T: RealField + Copy>(m: &Matrix) -> Matrix3<T> {
    Matrix3::from_fn(|i, j| convert(m[i][j]))
}

fn number<T: RealField + Copy>(value: T) -> f64 {
    try_convert(value).expect("a real number")
}

/// Axis and angle by the library, as numbers.
fn decomposed<T: RealField + Copy>(q: UnitQuaternion<T>) -> ([f64; 3], f64) {
    let turn = axis_angle(q);
    let axis = [turn.axis.x, turn.axis.y, turn.axis.z].map(number);
    (axis, number(turn.angle.rad()))
}

#[test]
fn the_units_multiply_as_eq_25_says() {
    let [one, i, j, k] = [0, 1, 2, 3].map(|n| {
        let mut c = [0.0; 4];
        c[n] = 1.0;
        Quaternion::new(c[0], c[1], c[2], c[3])
    });
    for product in [i * i, j * j, k * k, i * j * k] {
        assert_eq!(product, -one);
    }
    assert_eq!((i * j, j * i), (k, -k));
    assert_eq!((k * i, i * k), (j, -j));
    assert_eq!((j * k, k * j), (i, -i));
}

#[test]
fn sum_product_and_conjugate_are_those_of_eq_28_to_31() {
    let mut random = Random(21);
    for _ in 0..MANY {
        let (q, p) = (quaternion(&mut random, 9.0), quaternion(&mut random, 9.0));
        // With complex 2×2 matrices: q = (a, b), a = w + ix, b = y + iz.
        let ((a, b), (c, d)) = (((q.w, q.i), (q.j, q.k)), ((p.w, p.i), (p.j, p.k)));
        let times = |(r, i): (f64, f64), (s, k): (f64, f64)| (r * s - i * k, r * k + i * s);
        let bar = |(r, i): (f64, f64)| (r, -i);
        let (ac, bd) = (times(a, c), times(b, bar(d)));
        let (ad, bc) = (times(a, d), times(b, bar(c)));
        let expected = Quaternion::new(ac.0 - bd.0, ac.1 - bd.1, ad.0 + bc.0, ad.1 + bc.1);
        assert!((q * p - expected).norm() < 1e-12);
        assert_eq!((q + p).coords, q.coords + p.coords);
        // q q* is |q|², and lengths multiply.
        let square = q * q.conjugate();
        assert!((square.w - q.coords.norm_squared()).abs() < 1e-12);
        assert!(square.imag().norm() < 1e-12);
        assert!(((q * p).norm() - q.norm() * p.norm()).abs() < 1e-11);
    }
}

#[test]
fn every_quaternion_but_zero_has_the_inverse_of_eq_29() {
    let mut random = Random(22);
    for _ in 0..MANY {
        let q = quaternion(&mut random, 1.0) * 10.0_f64.powf(random.between(-300.0, 300.0));
        let back = inverse(q).expect("an inverse");
        assert!((q * back - Quaternion::identity()).norm() < 1e-12, "{q}");
    }
    assert_eq!(inverse(Quaternion::<f64>::from_real(0.0)), None);
    // Its inverse is larger than any number.
    assert_eq!(inverse(Quaternion::from_real(1e-310)), None);
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(inverse(Quaternion::new(1.0, 0.0, bad, 0.0)), None);
        assert_eq!(unit(Quaternion::new(1.0, 0.0, bad, 0.0)), None);
    }
    assert_eq!(unit(Quaternion::<f32>::from_real(0.0)), None);
}

#[test]
fn any_length_becomes_unit_length() {
    let mut random = Random(23);
    for _ in 0..MANY {
        let c = random_quaternion(&mut random);
        let size = 10.0_f64.powf(random.between(-300.0, 300.0));
        let [w, x, y, z] = c.map(|c| c * size);
        let q = unit(Quaternion::new(w, x, y, z)).expect("a direction");
        let difference = (q.coords - unit_quaternion::<f64>(c).coords).norm();
        assert!(difference < 1e-14, "{difference:e}");
    }
}

#[test]
fn what_rounding_on_the_wire_took_is_put_back() {
    // Section 5.4: three decimals, as the stream has them. Each is off by half of the last.
    let mut random = Random(31);
    for _ in 0..MANY {
        let c = random_quaternion(&mut random);
        let [w, x, y, z] = c.map(|c| (c * 1000.0).round() / 1000.0);
        let q = unit(Quaternion::new(w, x, y, z)).expect("a direction");
        assert_is_a_rotation(&q, 1e-12);
        let off = angle_between(&matrix(&q), &matrix(&unit_quaternion::<f64>(c)));
        assert!(off < 2.1e-3, "{off}");
    }
}

#[test]
fn the_length_of_the_2016_lecture_counts_one_part_twice() {
    let q = Quaternion::new(0.6, 0.4, 0.0, 0.48_f64.sqrt());
    assert!((q.norm() - 1.0).abs() < 1e-12);
    // As printed: q0² + q1² + q2² + q2².
    let printed = (q.w * q.w + q.i * q.i + q.j * q.j + q.j * q.j).sqrt();
    assert!((printed - 0.7211).abs() < 1e-4);
}

fn axis_and_angle_make_the_matrix<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(24);
    for _ in 0..MANY {
        let (axis, angle) = (random.direction(), random.between(-TAU, TAU));
        let size = 10.0_f64.powf(random.between(-30.0, 30.0));
        let q = from_axis_angle::<T>(
            vector(axis.map(|c| c * size)),
            Angle::from_rad(convert(angle)),
        );
        let made = matrix(&q.expect("an axis"));
        assert!(largest_difference(&made, &rotation(axis, angle)) < tolerance);
    }
}

#[test]
fn eq_13_and_35_turn_about_the_axis_by_the_angle() {
    axis_and_angle_make_the_matrix::<f64>(1e-9);
    axis_and_angle_make_the_matrix::<f32>(1e-5);
    let angle = Angle::from_rad(1.0);
    assert_eq!(from_axis_angle(Vector3::zeros(), angle), None);
    assert_eq!(from_axis_angle(Vector3::x() * f64::NAN, angle), None);
    let no_angle = Angle::from_rad(f64::INFINITY);
    assert_eq!(from_axis_angle(Vector3::x(), no_angle), None);
}

#[test]
fn rotating_forth_back_and_in_a_row_is_what_matrices_do() {
    let mut random = Random(25);
    for _ in 0..MANY {
        let [p, q] = [(); 2].map(|()| unit_quaternion::<f64>(random_quaternion(&mut random)));
        let u = random.vector(10.0);
        let near = |a: Vector3<f64>, b: [f64; 3]| (a - Vector3::from(b)).norm() < 1e-12;
        // Eq. 14, 15, 27 and 37, to the letter and as nalgebra does it.
        let q_u = Quaternion::from_imag(Vector3::from(u));
        let printed = q.into_inner() * q_u * inverse(q.into_inner()).expect("not zero");
        let turned = apply(&matrix(&q), u);
        assert!(near(printed.imag(), turned) && printed.w.abs() < 1e-12);
        assert!(near(q * Vector3::from(u), turned));
        // Eq. 38.
        assert!(near(q.inverse_transform_vector(&Vector3::from(turned)), u));
        // Eq. 16 and 39: first p, then q.
        let both = apply(&matrix(&q), apply(&matrix(&p), u));
        assert!(near((q * p) * Vector3::from(u), both));
    }
}

#[test]
fn eq_33_is_a_rotation_for_unit_quaternions_only() {
    let mut random = Random(26);
    for _ in 0..MANY {
        let (axis, angle) = (random.direction(), random.between(-PI, PI));
        let q = from_axis_angle(Vector3::from(axis), Angle::from_rad(angle)).expect("an axis");
        let r = q.to_rotation_matrix();
        let expected = nalgebra_matrix::<f64>(&rotation(axis, angle));
        assert!((r.matrix() - expected).norm() < 1e-9);
        // Twice as long, as printed: four times the rotation.
        let doubled = matrix(&UnitQuaternion::new_unchecked(q.into_inner() * 2.0));
        assert!((nalgebra_matrix::<f64>(&doubled) - expected * 4.0).norm() < 1e-9);
    }
}

/// Eq. 34 as printed.
fn printed_from_matrix(r: &Matrix) -> [f64; 4] {
    let w = (1.0 + r[0][0] + r[1][1] + r[2][2]).sqrt() / 2.0;
    let v = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]].map(|d| d / (4.0 * w));
    [w, v[0], v[1], v[2]]
}

fn matrices_come_back<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(27);
    for round in 0..MANY {
        // Every other one close to half a turn, where eq. 34 gives way.
        let near = 10.0_f64.powf(random.between(-17.0, 0.0));
        let angle = [random.between(-PI, PI), PI - near][round % 2];
        let r = rotation(random.direction(), angle);
        let q = from_matrix::<T>(&nalgebra_matrix(&r)).expect("a rotation");
        assert!(q.w >= T::zero());
        assert_is_a_rotation(&q, tolerance);
        assert!(largest_difference(&matrix(&q), &r) < tolerance, "{angle}");
    }
}

#[test]
fn eq_34_is_extended_to_every_matrix() {
    matrices_come_back::<f64>(1e-9);
    matrices_come_back::<f32>(1e-5);
    // As printed: the same for small turns, and not a number for half a turn.
    let r = rotation([0.6, 0.0, 0.8], 1.0);
    let q = from_matrix::<f64>(&nalgebra_matrix(&r)).expect("a rotation");
    let pairs = printed_from_matrix(&r).into_iter().zip(components(&q));
    assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12));
    let half = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
    assert!(printed_from_matrix(&half)[1].is_nan());
    let q = from_matrix::<f64>(&nalgebra_matrix(&half)).expect("a rotation");
    assert_eq!(components(&q), [0.0, 1.0, 0.0, 0.0]);
    // The four squares equal, q = (½, ½, ½, ½): the axes in turn.
    let cycle = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let q = from_matrix::<f64>(&nalgebra_matrix(&cycle)).expect("a rotation");
    assert_eq!(components(&q), [0.5; 4]);
}

#[test]
fn a_matrix_that_is_no_rotation_is_told_so() {
    let r = nalgebra_matrix::<f64>(&rotation([0.6, 0.0, 0.8], 1.0));
    assert_eq!(from_matrix(&(r * 1.1)), Err(NotARotation::NotOrthonormal));
    assert_eq!(
        from_matrix(&(r * f64::NAN)),
        Err(NotARotation::NotOrthonormal)
    );
    assert_eq!(from_matrix(&(r * 1e300)), Err(NotARotation::NotOrthonormal));
    assert_eq!(from_matrix(&-r), Err(NotARotation::Mirrored));
    // Rounded to three decimals it still passes, and comes out of unit length.
    let q = from_matrix(&r.map(|c| (c * 1000.0).round() / 1000.0)).expect("a rotation");
    assert_is_a_rotation(&q, 1e-12);
    assert!((q.angle() - 1.0).abs() < 1e-3);
}

/// Eq. 36 as printed: θ and the axis.
fn printed_axis_angle([w, x, y, z]: [f64; 4]) -> (f64, [f64; 3]) {
    (2.0 * w.acos(), [x, y, z].map(|c| c / (1.0 - w * w).sqrt()))
}

fn axis_and_angle_come_back<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(28);
    for _ in 0..MANY {
        let (axis, angle) = (random.direction(), random.between(0.0, PI));
        let (sin, cos) = (angle / 2.0).sin_cos();
        let q = [cos, axis[0] * sin, axis[1] * sin, axis[2] * sin];
        // As it is, negated, and of another length.
        for factor in [1.0, -1.0, 1.001] {
            let (v, theta) = decomposed(unit_quaternion::<T>(q.map(|c| c * factor)));
            assert!((theta - angle).abs() < tolerance, "{angle}");
            assert!((length(v) - 1.0).abs() < 1e-6);
            let off = (0..3).map(|i| (v[i] - axis[i]).abs()).fold(0.0, larger);
            // Of half a turn either end of the axis is right.
            assert!(off < tolerance || PI - angle < tolerance, "{angle} {v:?}");
        }
    }
}

#[test]
fn eq_36_goes_the_short_way_for_q_and_minus_q() {
    axis_and_angle_come_back::<f64>(1e-9);
    axis_and_angle_come_back::<f32>(1e-5);
    // As printed, q = (−cos 5°, …) is a turn of 350°. It is one of 10° about the axis reversed.
    let (sin, cos) = 5.0_f64.to_radians().sin_cos();
    let q = [-cos, sin, 0.0, 0.0];
    assert!((printed_axis_angle(q).0.to_degrees() - 350.0).abs() < 1e-9);
    let (v, theta) = decomposed(unit_quaternion::<f64>(q));
    assert!((theta.to_degrees() - 10.0).abs() < 1e-9 && v[0] == -1.0);
}

#[test]
fn eq_36_is_closed_at_the_identity_beyond_one_and_at_half_turns() {
    // As printed 0/0, and the arc cosine of more than 1.
    assert!(printed_axis_angle([1.0, 0.0, 0.0, 0.0]).1[0].is_nan());
    assert!(printed_axis_angle([1.0 + 1e-15, 1e-9, 0.0, 0.0]).0.is_nan());
    for q in [[1.0, 0.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.0]] {
        assert_eq!(
            decomposed(unit_quaternion::<f64>(q)),
            ([1.0, 0.0, 0.0], 0.0)
        );
    }
    let (v, theta) = decomposed(unit_quaternion::<f64>([1.0 + 1e-15, 1e-9, 0.0, 0.0]));
    assert!((theta - 2e-9).abs() < 1e-18 && v == [1.0, 0.0, 0.0]);
    for sign in [1.0, -1.0] {
        let q = [0.0, 0.0, 0.6, -0.8].map(|c: f64| c * sign);
        let (v, theta) = decomposed(unit_quaternion::<f64>(q));
        assert!((theta - PI).abs() < 1e-12 && v[0] == 0.0);
        assert!((v[1] - 0.6).abs() < 1e-12 && (v[2] + 0.8).abs() < 1e-12);
    }
    // What is no rotation at all is taken for none.
    assert_eq!(decomposed(unit_quaternion::<f64>([0.0; 4])).1, 0.0);
    assert_eq!(decomposed(unit_quaternion::<f64>([f64::NAN; 4])).1, 0.0);
}

#[test]
fn a_small_angle_survives_single_precision() {
    for angle in [1e-3, 1e-4, 1e-5, 1e-20] {
        let q = from_axis_angle(Vector3::<f32>::z(), Angle::from_rad(angle)).expect("an axis");
        let theta = axis_angle(q).angle.rad();
        assert!((theta / angle - 1.0).abs() < 1e-6, "{angle} {theta}");
    }
    // As printed: cos 5e-5 is 1.
    assert_eq!(2.0 * (5e-5_f32).cos().acos(), 0.0);
}

fn halfway_is_even<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(29);
    for _ in 0..MANY / 2 {
        let (start, axis) = (random_quaternion(&mut random), random.direction());
        let (angle, part) = (random.between(0.0, 0.999 * PI), random.unit());
        let a = unit_quaternion::<f64>(start);
        let turn = from_axis_angle(Vector3::from(axis), Angle::from_rad(angle)).expect("an axis");
        let sign = if random.unit() < 0.5 { 1.0 } else { -1.0 };
        let b = components(&(a * turn)).map(|c| c * sign);
        let q = slerp::<T>(unit_quaternion(start), unit_quaternion(b), convert(part));
        let expected = product(&matrix(&a), &rotation(axis, part * angle));
        assert!(largest_difference(&matrix(&q), &expected) < tolerance);
    }
}

#[test]
fn interpolation_turns_evenly_the_short_way() {
    // Single precision leaves the axis of a nearly full half turn a little uncertain.
    halfway_is_even::<f64>(1e-9);
    halfway_is_even::<f32>(1e-5);
}

#[test]
fn interpolation_has_ends_and_no_gaps() {
    let a = unit_quaternion::<f64>([0.5, 0.5, 0.5, 0.5]);
    let b = unit_quaternion::<f64>([0.0, 0.6, 0.0, -0.8]);
    let same = |p, q| largest_difference(&matrix(&p), &matrix(&q)) < 1e-12;
    for (fraction, end) in [(0.0, a), (-3.0, a), (f64::NAN, a), (1.0, b), (7.0, b)] {
        assert!(same(slerp(a, b, fraction), end), "{fraction}");
    }
    assert!(same(slerp(a, a, 0.5), a) && same(slerp(a, unit_quaternion([-0.5; 4]), 0.5), a));
    // Half a turn apart: a quarter turn either way is halfway.
    let opposite = a * unit_quaternion::<f64>([0.0, 0.0, 1.0, 0.0]);
    let middle = matrix(&slerp(a, opposite, 0.5));
    assert!((angle_between(&matrix(&a), &middle) - FRAC_PI_2).abs() < 1e-12);
    assert!((angle_between(&matrix(&opposite), &middle) - FRAC_PI_2).abs() < 1e-12);
}

#[test]
fn euler_angles_do_not_interpolate() {
    // Pitch 80° and pitch 100° (which Euler angles call yaw 180°, pitch 80°, roll 180°).
    let euler = |degrees: [f64; 3]| {
        let [yaw, pitch, roll] = degrees.map(f64::to_radians);
        let tilt = product(
            &rotation([1.0, 0.0, 0.0], pitch),
            &rotation([0.0, 0.0, 1.0], roll),
        );
        product(&rotation([0.0, 1.0, 0.0], yaw), &tilt)
    };
    let (from, to) = (euler([0.0, 80.0, 0.0]), euler([180.0, 80.0, 180.0]));
    let [a, b] = [&from, &to].map(|r| from_matrix(&nalgebra_matrix(r)).expect("a rotation"));
    let path = |at: &dyn Fn(f64) -> Matrix| {
        let steps = (0..1000).map(|i| (f64::from(i) / 1000.0, f64::from(i + 1) / 1000.0));
        let angles = steps.map(|(s, t)| angle_between(&at(s), &at(t)));
        angles.sum::<f64>().to_degrees()
    };
    let by_quaternion = path(&|t| matrix(&slerp::<f64>(a, b, t)));
    let by_angles = path(&|t| euler([180.0 * t, 80.0, 180.0 * t]));
    assert!((by_quaternion - 20.0).abs() < 1e-6, "{by_quaternion}");
    assert!((by_angles - 31.4).abs() < 0.1, "{by_angles}");
    // Halfway they look straight up, or 10° past it.
    let up = euler([0.0, 90.0, 0.0]);
    assert!(angle_between(&matrix(&slerp::<f64>(a, b, 0.5)), &up) < 1e-9);
    let aside = angle_between(&euler([90.0, 80.0, 90.0]), &up).to_degrees();
    assert!((aside - 10.0).abs() < 1e-9, "{aside}");
}

fn survives<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(30);
    for _ in 0..MANY {
        let mut any = || convert::<f64, T>(anything(&mut random));
        let [q, p] = [(); 2].map(|()| Quaternion::new(any(), any(), any(), any()));
        let (v, angle) = (Vector3::new(any(), any(), any()), Angle::from_rad(any()));
        for rotation in [unit(q), from_axis_angle(v, angle)].into_iter().flatten() {
            assert_is_a_rotation(&rotation, tolerance);
        }
        if let Some(back) = inverse(q) {
            assert!(back.coords.iter().all(|c| c.is_finite()));
        }
        let [q, p] = [q, p].map(UnitQuaternion::new_unchecked);
        let (v, theta) = decomposed(q);
        assert!((length(v) - 1.0).abs() <= tolerance && (0.0..=PI + tolerance).contains(&theta));
        assert_is_a_rotation(&slerp(q, p, any()), tolerance);
        if let Ok(rotation) = from_matrix(&Matrix3::from_fn(|_, _| any())) {
            assert_is_a_rotation(&rotation, tolerance);
        }
    }
}

#[test]
fn no_input_makes_anything_but_a_rotation_or_a_none() {
    survives::<f64>(1e-10);
    survives::<f32>(1e-6);
}
