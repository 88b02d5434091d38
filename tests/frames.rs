//! The conversions between the documents' conventions, against frames written out as directions.

mod matrices;

mod random;

#[path = "view/rotations.rs"]
mod rotations;

use nalgebra::{Matrix3, Quaternion, RealField, UnitQuaternion, Vector3, try_convert};
use rotations::{Matrix, Random, Vector, apply, axis_angle, larger, product, rotation, transpose};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, TAU};
use vrduino::frames::angles::{short_way, whole_turn};
use vrduino::frames::axes::Axes;
use vrduino::frames::gravity::Gravity;
use vrduino::frames::weight::GyroWeight;
use vrduino::frames::{layout, passive, product as side};
use vrduino::orientation::tilt;
use vrduino::units::{Angle, AngularRate, SpecificForce};
use vrduino::virtual_gyro::angles::TaitBryan;

const INPUTS: usize = 2_000_000;

const EAST: Vector = [1.0, 0.0, 0.0];
const WEST: Vector = [-1.0, 0.0, 0.0];
const UP: Vector = [0.0, 1.0, 0.0];
const DOWN: Vector = [0.0, -1.0, 0.0];
const SOUTH: Vector = [0.0, 0.0, 1.0];
const NORTH: Vector = [0.0, 0.0, -1.0];

/// The axes of each frame as directions of the y-up world.
const FRAMES: [(Axes, [Vector; 3]); 4] = [
    (Axes::YUp, [EAST, UP, SOUTH]),
    (Axes::NorthEastDown, [NORTH, EAST, DOWN]),
    (Axes::EastNorthUp, [EAST, NORTH, UP]),
    // The post: “replace z in the above image with y, x with z, and y with x”.
    (Axes::Picture, [SOUTH, EAST, UP]),
];

fn quaternion<T: RealField + Copy>(axis: Vector, angle: f64) -> UnitQuaternion<T> {
    let (sin, cos) = (angle / 2.0).sin_cos();
    let [x, y, z] = axis.map(|component| component * sin);
    let [w, x, y, z] = [cos, x, y, z].map(nalgebra::convert);
    UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z))
}

/// The largest difference of a matrix from the reference.
fn off<T: RealField + Copy>(matrix: &Matrix3<T>, reference: &Matrix) -> f64 {
    (0..9)
        .map(|k| (number(matrix[(k / 3, k % 3)]) - reference[k / 3][k % 3]).abs())
        .fold(0.0, larger)
}

fn number<T: RealField + Copy>(x: T) -> f64 {
    try_convert(x).expect("a real number")
}

/// Eq. 33.
fn matrix<T: RealField + Copy>(q: UnitQuaternion<T>) -> Matrix3<T> {
    q.to_rotation_matrix().into_inner()
}

#[test]
fn every_frame_is_right_handed_and_its_axes_point_where_they_are_named() {
    for (axes, directions) in FRAMES {
        let [x, y, z] = directions.map(Vector3::from);
        assert_eq!(x.cross(&y), z, "{axes:?}");
        let named = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| axes.to_y_up(axis));
        assert_eq!(named, [x, y, z], "{axes:?}");
    }
    // The compass marks of the documents' text.
    let ned = |direction: Vector| Axes::NorthEastDown.from_y_up(Vector3::from(direction));
    assert_eq!(
        [NORTH, EAST, DOWN].map(ned),
        [Vector3::x(), Vector3::y(), Vector3::z()]
    );
    assert_eq!([WEST, UP].map(ned), [-Vector3::y(), -Vector3::z()]);
}

#[test]
fn vectors_come_back_from_every_frame_to_the_bit() {
    let mut random = Random(1);
    for _ in 0..INPUTS {
        let v = Vector3::from(random.vector(100.0));
        for (axes, [x, y, z]) in FRAMES {
            let [x, y, z] = [x, y, z].map(Vector3::from);
            assert_eq!(axes.to_y_up(v), x * v.x + y * v.y + z * v.z, "{axes:?}");
            assert_eq!(axes.from_y_up(axes.to_y_up(v)), v, "{axes:?}");
            assert_eq!(axes.to_y_up(axes.from_y_up(v)), v, "{axes:?}");
        }
    }
}

#[test]
fn an_orientation_in_other_axes_is_the_same_turn() {
    fn worst<T: RealField + Copy>() -> f64 {
        let (mut random, mut worst) = (Random(2), 0.0_f64);
        for _ in 0..INPUTS {
            let (axis, angle) = axis_angle(&mut random);
            let q = quaternion::<T>(axis, angle);
            for (axes, directions) in FRAMES {
                // C R Cᵀ, where the columns of C are the directions.
                let c = transpose(&directions);
                let expected = product(&c, &product(&rotation(axis, angle), &directions));
                worst = larger(worst, off(&matrix(axes.orientation_to_y_up(q)), &expected));
                let back = axes.orientation_from_y_up(axes.orientation_to_y_up(q));
                assert_eq!(back, q, "{axes:?}");
            }
        }
        worst
    }
    assert!(worst::<f64>() < 1e-9);
    assert!(worst::<f32>() < 1e-5);
}

#[test]
fn gravity_is_what_the_accelerometer_reads_turned_round() {
    let mut random = Random(3);
    let ned = transpose(&[NORTH, EAST, DOWN]);
    for _ in 0..INPUTS {
        let (axis, angle) = axis_angle(&mut random);
        let board = rotation(axis, angle);
        // At rest: 9.81 m/s² up, seen from the board.
        let up = apply(&transpose(&board), [0.0, 9.81, 0.0]);
        let force = SpecificForce::from_m_per_s2(Vector3::from(up));
        let gravity = Gravity::from_accelerometer(force);
        let found = Axes::NorthEastDown.from_y_up(gravity.m_per_s2());
        // In the paper's frames: 9.81 m/s² along z, seen from the device.
        let device = product(&transpose(&ned), &product(&board, &ned));
        let expected = Vector3::from(apply(&transpose(&device), [0.0, 0.0, 9.81]));
        assert!((found - expected).norm() < 1e-9);
        assert_eq!(gravity.accelerometer(), force);
        assert_eq!(Gravity::from_m_per_s2(gravity.m_per_s2()), gravity);
    }
}

#[test]
fn the_scalar_is_first_in_the_notes_and_last_in_the_paper() {
    let q = layout::from_scalar_first([1.0, 2.0, 3.0, 4.0]);
    assert_eq!((q.w, q.i, q.j, q.k), (1.0, 2.0, 3.0, 4.0));
    assert_eq!(layout::to_scalar_last(q), [2.0, 3.0, 4.0, 1.0]);
    assert_eq!(layout::from_scalar_last([2.0, 3.0, 4.0, 1.0]), q);
    assert_eq!(layout::to_scalar_first(q), [1.0, 2.0, 3.0, 4.0]);
    // A quarter turn about z read in the wrong order is another rotation.
    let quarter = [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2];
    let unit = UnitQuaternion::new_normalize;
    let right = unit(layout::from_scalar_first(quarter));
    let wrong = unit(layout::from_scalar_last(quarter));
    assert!((right.angle_to(&wrong).to_degrees() - 120.0).abs() < 1e-9);
}

#[test]
fn a_passive_matrix_is_the_transpose_of_the_active_one() {
    fn worst<T: RealField + Copy>() -> f64 {
        let (mut random, mut worst) = (Random(4), 0.0_f64);
        for _ in 0..INPUTS {
            let (axis, angle) = axis_angle(&mut random);
            let active = rotation(axis, angle);
            let found = passive::matrix(quaternion::<T>(axis, angle));
            worst = larger(worst, off(&found, &transpose(&active)));
            let back = passive::orientation(found).expect("a rotation");
            worst = larger(worst, off(&matrix(back), &active));
            worst = larger(worst, number((back.norm() - T::one()).abs()));
        }
        worst
    }
    assert!(worst::<f64>() < 1e-9);
    assert!(worst::<f32>() < 1e-5);
    // The paper's quaternion of M is eq. 34 of the transpose; eq. 34 of M itself turns backwards.
    let q = quaternion::<f64>([0.0, 0.0, 1.0], 0.5);
    let m = passive::matrix(q);
    assert!(passive::orientation(m).expect("a rotation").angle_to(&q) < 1e-9);
    let [w, z] = [(1.0 + m.trace()).sqrt() / 2.0, m[(1, 0)] - m[(0, 1)]];
    let printed = UnitQuaternion::new_normalize(Quaternion::new(w, 0.0, 0.0, z / (4.0 * w)));
    assert!(printed.angle_to(&q.conjugate()) < 1e-9);
}

#[test]
fn a_matrix_that_is_no_rotation_has_no_orientation() {
    let identity = Matrix3::<f32>::identity();
    let skewed = identity + Matrix3::from_fn(|i, j| if (i, j) == (0, 1) { 0.01 } else { 0.0 });
    let bad = [
        identity * 0.0,
        -identity,
        identity * 1.01,
        skewed,
        identity * f32::NAN,
    ];
    for matrix in bad.into_iter().chain([identity * f32::INFINITY]) {
        assert!(passive::orientation(matrix).is_err(), "{matrix}");
    }
    assert_eq!(
        passive::orientation(identity),
        Ok(UnitQuaternion::identity())
    );
}

#[test]
fn a_step_on_the_right_is_another_step_on_the_left() {
    fn worst<T: RealField + Copy>() -> f64 {
        let (mut random, mut worst) = (Random(5), 0.0_f64);
        for _ in 0..INPUTS {
            let [(a, alpha), (b, beta)] = [(); 2].map(|()| axis_angle(&mut random));
            let (q, step) = (quaternion::<T>(a, alpha), quaternion::<T>(b, beta));
            let turned = rotation(a, alpha);
            // The world step is about the body's axis as it stands in the world.
            let in_world = side::step_in_world(q, step);
            let expected = rotation(apply(&turned, b), beta);
            worst = larger(worst, off(&matrix(in_world), &expected));
            worst = larger(
                worst,
                off(&matrix(in_world * q), &product(&turned, &rotation(b, beta))),
            );
            let in_body = side::step_in_body(q, step);
            let expected = rotation(apply(&transpose(&turned), b), beta);
            worst = larger(worst, off(&matrix(in_body), &expected));
        }
        worst
    }
    assert!(worst::<f64>() < 1e-9);
    assert!(worst::<f32>() < 1e-5);
}

#[test]
fn the_left_product_of_the_post_fits_a_step_in_world_axes() {
    // 90° about x, and then the gyro reads 90° about the body's y.
    let q = quaternion::<f64>([1.0, 0.0, 0.0], FRAC_PI_2);
    let step = quaternion([0.0, 1.0, 0.0], FRAC_PI_2);
    let right = q * step;
    for component in layout::to_scalar_first(right.into_inner()) {
        assert!((component - 0.5).abs() < 1e-9);
    }
    let printed = step * q;
    assert!((printed.angle_to(&right).to_degrees() - 120.0).abs() < 1e-9);
    assert!((side::step_in_world(q, step) * q).angle_to(&right) < 1e-9);
}

#[test]
fn the_papers_angles_are_the_notes_with_yaw_and_roll_negated() {
    let mut random = Random(6);
    let ned = transpose(&[NORTH, EAST, DOWN]);
    for _ in 0..INPUTS {
        let [roll, pitch, yaw] = random.vector(PI);
        let paper = TaitBryan {
            roll: Angle::from_rad(roll),
            pitch: Angle::from_rad(pitch),
            yaw: Angle::from_rad(yaw),
        };
        // R(φ, θ, ψ) = R_x R_y R_z with the passive matrices of section 3.1, reference to device.
        let r_z = transpose(&rotation([0.0, 0.0, 1.0], yaw));
        let r_y = transpose(&rotation([0.0, 1.0, 0.0], pitch));
        let r_x = transpose(&rotation([1.0, 0.0, 0.0], roll));
        let active = transpose(&product(&r_x, &product(&r_y, &r_z)));
        let expected = product(&ned, &product(&active, &transpose(&ned)));
        // The inverse of eq. 10: body to world R_y R_x R_z.
        let notes = paper.to_notes();
        let r_y = rotation([0.0, 1.0, 0.0], notes.yaw.rad());
        let r_x = rotation([1.0, 0.0, 0.0], notes.pitch.rad());
        let r_z = rotation([0.0, 0.0, 1.0], notes.roll.rad());
        let found = product(&r_y, &product(&r_x, &r_z));
        assert!((0..9).all(|k| (found[k / 3][k % 3] - expected[k / 3][k % 3]).abs() < 1e-9));
        assert_eq!(notes.to_paper(), paper);
    }
}

#[test]
fn what_is_no_rotation_counts_as_none() {
    let identity = UnitQuaternion::<f64>::identity();
    let q = quaternion::<f64>([0.6, 0.0, 0.8], 1.1);
    for w in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0] {
        let none = UnitQuaternion::new_unchecked(Quaternion::new(w, 0.0, 0.0, 0.0));
        assert_eq!(passive::matrix(none), Matrix3::identity());
        for step in [side::step_in_world, side::step_in_body] {
            assert!(step(none, q).angle_to(&q) < 1e-9);
            assert_eq!(step(q, none).angle_to(&identity), 0.0);
            assert_eq!(step(none, none), identity);
        }
    }
    for length in [1e-200, 1e200] {
        let other = UnitQuaternion::new_unchecked(q.into_inner() * length);
        assert!((passive::matrix(other) - passive::matrix(q)).amax() < 1e-9);
        assert!((side::step_in_world(other, other).norm() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn degrees_and_radians_are_there_and_back() {
    assert!((Angle::from_degrees(180.0).rad() - PI).abs() < 1e-12);
    assert!((Angle::from_rad(FRAC_PI_2).degrees() - 90.0).abs() < 1e-12);
    assert!((Angle::from_degrees(180.0_f32).rad() - std::f32::consts::PI).abs() < 1e-6);
    let mut random = Random(7);
    for _ in 0..INPUTS {
        let dps = Vector3::from(random.vector(2000.0));
        let rate = AngularRate::from_dps(dps);
        assert!((rate.rad_per_s() * 180.0 / PI - dps).norm() < 1e-9);
        let back = AngularRate::from_rad_per_s(rate.rad_per_s()).dps();
        assert!((back - dps).norm() < 1e-9);
    }
}

#[test]
fn an_angle_keeps_its_direction_in_either_range() {
    let mut random = Random(8);
    for _ in 0..INPUTS {
        let angle = random.between(-100.0, 100.0);
        let whole = whole_turn(Angle::from_rad(angle)).expect("finite").rad();
        let short = short_way(Angle::from_rad(angle)).expect("finite").rad();
        assert!((0.0..=TAU).contains(&whole) && short.abs() <= PI);
        for found in [whole, short] {
            assert!((found.cos() - angle.cos()).abs() < 1e-9);
            assert!((found.sin() - angle.sin()).abs() < 1e-9);
        }
    }
    // A drift of 350° is one of −10°: α of it is to be taken of the short way.
    let drift = short_way(Angle::from_degrees(350.0_f64)).expect("finite");
    assert!((drift.degrees() + 10.0).abs() < 1e-9);
    for huge in [f32::MAX, -f32::MAX, 1e10] {
        let short = short_way(Angle::from_rad(huge)).expect("finite").rad();
        assert!(short.abs() <= std::f32::consts::PI);
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(whole_turn(Angle::from_rad(bad)), None);
        assert_eq!(short_way(Angle::from_rad(bad)), None);
    }
}

#[test]
fn the_notes_and_the_post_correct_a_tilt_alike() {
    let mut random = Random(9);
    for _ in 0..INPUTS {
        let [x, y, z] = random.direction();
        let horizontal = x.hypot(z);
        if horizontal < 1e-6 {
            continue;
        }
        let weight = GyroWeight::new(random.between(0.0, 1.0)).expect("in range");
        // The post: q(t, −αφ) with t = (u_z, 0, −u_x).
        let t = [z / horizontal, 0.0, -x / horizontal];
        let post = rotation(t, -weight.correction_gain() * horizontal.atan2(y));
        // The notes: q((1 − α)φ, n) with n = (−v_z, 0, v_x).
        let force = SpecificForce::from_m_per_s2(Vector3::new(x, y, z));
        let notes = tilt::correction(force, 1.0 - weight.alpha());
        assert!(off(&matrix(notes), &post) < 1e-9);
        // With +α as the post says in words, “positive from u towards ŷ”, it would tilt further. (Next to
        // up that is less than rounding, next to down it passes the other side.)
        if horizontal > 0.01 {
            let in_words = rotation(t, 1e-3 * horizontal.atan2(y));
            assert!(apply(&in_words, [x, y, z])[1] < y);
        }
    }
}

#[test]
fn a_weight_is_from_zero_to_one_by_either_name() {
    let weight = GyroWeight::new(0.75).expect("in range");
    assert_eq!((weight.alpha(), weight.correction_gain()), (0.75, 0.25));
    assert_eq!(GyroWeight::from_correction_gain(0.25), Some(weight));
    for bad in [-0.1, 1.1, f32::NAN, f32::INFINITY] {
        assert_eq!(GyroWeight::new(bad), None);
        assert_eq!(GyroWeight::from_correction_gain(bad), None);
    }
}
