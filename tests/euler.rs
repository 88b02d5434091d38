//! Orientation in three angles (course notes, eq. 10; both lectures), and why nobody tracks with
//! them (2016 lecture).

mod matrices;

mod random;

#[path = "euler/lecture.rs"]
mod lecture;

use matrices::{Matrix, apply, degrees_between, largest_difference, product, transpose, turn};
use nalgebra::{Matrix4, Point3, Quaternion, RealField, UnitQuaternion, Vector3, convert};
use random::{ODD, Random};
use std::f64::consts::{FRAC_PI_2, PI};
use vrduino::calibration::{GyroBias, Reading};
use vrduino::orientation::TimeConstant;
use vrduino::orientation::complementary::Complementary;
use vrduino::orientation::euler::lecture::{LectureComplementary, LectureDeadReckoning};
use vrduino::orientation::euler::{EulerAngles, to_clip_space};
use vrduino::orientation::gyro::DeadReckoning;
use vrduino::sensor::Sample;
use vrduino::units::{Angle, AngularRate, Seconds, SpecificForce};

const G: f64 = 9.81;

/// R_z(−θ_z) R_x(−θ_x) R_y(−θ_y) of eq. 10, as it is printed there.
fn eq_10(yaw: f64, pitch: f64, roll: f64) -> Matrix {
    let (sz, cz) = (-roll).sin_cos();
    let (sx, cx) = (-pitch).sin_cos();
    let (sy, cy) = (-yaw).sin_cos();
    let about_z = [[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]];
    let about_x = [[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]];
    let about_y = [[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]];
    product(&product(&about_z, &about_x), &about_y)
}

fn angles<T: RealField + Copy>(yaw: f64, pitch: f64, roll: f64) -> EulerAngles<T> {
    let angle = |rad: f64| Angle::from_rad(convert(rad));
    EulerAngles {
        yaw: angle(yaw),
        pitch: angle(pitch),
        roll: angle(roll),
    }
}

fn degrees(yaw: f64, pitch: f64, roll: f64) -> EulerAngles<f64> {
    angles(yaw.to_radians(), pitch.to_radians(), roll.to_radians())
}

fn radians<T: RealField + Copy>(a: EulerAngles<T>) -> [f64; 3] {
    let as_f64 = |a: Angle<T>| nalgebra::try_convert::<T, f64>(a.rad()).expect("a real number");
    [a.yaw, a.pitch, a.roll].map(as_f64)
}

/// Body to world, by eq. 10.
fn matrix<T: RealField + Copy>(a: EulerAngles<T>) -> Matrix {
    let [yaw, pitch, roll] = radians(a);
    transpose(&eq_10(yaw, pitch, roll))
}

fn columns(q: UnitQuaternion<f64>) -> Matrix {
    let m = q.to_rotation_matrix();
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| m[(i, j)]))
}

/// What perfect sensors read on a body with this orientation (body to world) and rate (body).
fn reading(truth: &Matrix, rate: [f64; 3]) -> Reading<f64> {
    let force = apply(&transpose(truth), [0.0, G, 0.0]);
    GyroBias::zero().correct(Sample {
        rate: AngularRate::from_rad_per_s(Vector3::from(rate)),
        force: SpecificForce::from_m_per_s2(Vector3::from(force)),
    })
}

fn conversions<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(1);
    for i in 0..2_000_000 {
        let (yaw, roll) = (random.between(-PI, PI), random.between(-PI, PI));
        // Every third one is close to gimbal lock, at every distance from it.
        let pitch = match i % 3 {
            0 => FRAC_PI_2 - 10.0_f64.powf(random.between(-18.0, 0.0)),
            1 => 10.0_f64.powf(random.between(-18.0, 0.0)) - FRAC_PI_2,
            _ => random.between(-FRAC_PI_2, FRAC_PI_2),
        };
        let these = angles::<T>(yaw, pitch, roll);
        let expected = eq_10(yaw, pitch, roll);
        let r = these.world_to_body();
        for (row, elements) in expected.iter().enumerate() {
            for (column, element) in elements.iter().enumerate() {
                let difference = r[(row, column)] - convert(*element);
                assert!(difference.abs() < convert(tolerance), "{these:?}");
            }
        }
        let q = these.orientation();
        let product = r * q.to_rotation_matrix();
        assert!((product.matrix() - nalgebra::Matrix3::identity()).norm() < convert(tolerance));
        // Back to angles: the same orientation, and away from gimbal lock the same angles.
        let found = EulerAngles::of(q);
        let again = found.world_to_body();
        assert!(
            (again.matrix() - r.matrix()).norm() < convert(tolerance),
            "{these:?}"
        );
        if i % 3 == 2 {
            for (is, expected) in radians(found).into_iter().zip([yaw, pitch, roll]) {
                let seam = (is - expected).abs() > PI;
                let limit = 2.0 * tolerance / pitch.cos();
                assert!(seam || (is - expected).abs() < limit, "{these:?} {found:?}");
            }
        }
    }
}

#[test]
fn angles_are_the_matrices_of_eq_10_and_come_back_from_quaternions() {
    conversions::<f64>(1e-9);
}

#[test]
fn angles_are_the_matrices_of_eq_10_in_single_precision() {
    conversions::<f32>(1e-5);
}

#[test]
fn at_gimbal_lock_yaw_has_the_turn_and_roll_is_zero() {
    for (pitch, yaw) in [(90.0, 20.0 - 50.0), (-90.0, 20.0 + 50.0)] {
        let found = EulerAngles::of(degrees(20.0, pitch, 50.0).orientation());
        assert_eq!(found.roll.rad(), 0.0);
        assert!((found.yaw.degrees() - yaw).abs() < 1e-9, "{found:?}");
        assert!((found.pitch.degrees() - pitch).abs() < 1e-9);
    }
    let nothing = UnitQuaternion::new_unchecked(Quaternion::new(f64::NAN, 0.0, 0.0, 0.0));
    assert_eq!(EulerAngles::of(nothing), EulerAngles::zero());
    let nothing = UnitQuaternion::new_unchecked(Quaternion::new(0.0_f64, 0.0, 0.0, 0.0));
    assert_eq!(EulerAngles::of(nothing), EulerAngles::zero());
}

#[test]
fn an_angle_that_is_not_finite_counts_as_zero() {
    let sound = [0.1, 0.2, 0.3];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for which in 0..3 {
            let (mut given, mut taken) = (sound, sound);
            (given[which], taken[which]) = (bad, 0.0);
            let [yaw, pitch, roll] = given;
            let found = angles::<f64>(yaw, pitch, roll);
            let [yaw, pitch, roll] = taken;
            let expected = eq_10(yaw, pitch, roll);
            let to_body = found.world_to_body();
            let to_body = [0, 1, 2].map(|i| [0, 1, 2].map(|j| to_body[(i, j)]));
            assert!(largest_difference(&to_body, &expected) < 1e-12);
            let to_world = columns(found.orientation());
            assert!(largest_difference(&to_world, &transpose(&expected)) < 1e-12);
        }
    }
}

#[test]
fn the_rates_of_the_angles_integrate_to_the_turn_of_the_body() {
    // Runge and Kutta on the rates against the matrix exponential.
    let rate = [0.5, -0.4, 0.7];
    let step = 0.001;
    let slope = |[yaw, pitch, roll]: [f64; 3]| {
        let rate = AngularRate::from_rad_per_s(Vector3::from(rate));
        let rates = angles::<f64>(yaw, pitch, roll)
            .rates(rate)
            .expect("no lock");
        [
            rates.yaw_rad_per_s,
            rates.pitch_rad_per_s,
            rates.roll_rad_per_s,
        ]
    };
    let along = |a: [f64; 3], b: [f64; 3], t: f64| [0, 1, 2].map(|i| a[i] + t * b[i]);
    let mut state = [0.3, -0.4, 1.1];
    let start = matrix(angles::<f64>(0.3, -0.4, 1.1));
    for _ in 0..1000 {
        let k1 = slope(state);
        let k2 = slope(along(state, k1, step / 2.0));
        let k3 = slope(along(state, k2, step / 2.0));
        let k4 = slope(along(state, k3, step));
        state =
            [0, 1, 2].map(|i| state[i] + step / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    let expected = product(&start, &turn(rate, 1.0));
    let found = matrix(angles::<f64>(state[0], state[1], state[2]));
    assert!(degrees_between(&found, &expected).to_radians() < 1e-9);
    let any = AngularRate::from_rad_per_s(Vector3::new(1.0, 1.0, 1.0));
    assert_eq!(degrees(10.0, 90.0, 20.0).rates(any), None);
    assert_eq!(degrees(10.0, -90.0, 20.0).rates(any), None);
}

#[test]
fn half_way_in_angles_is_not_half_way_between_two_keyframes() {
    // Both lectures: interpolating Euler angles is problematic. Pitch 80° and “pitch 100°”, 20° apart.
    let (first, last) = (degrees(0.0, 80.0, 0.0), degrees(180.0, 80.0, 180.0));
    assert!((degrees_between(&matrix(first), &matrix(last)) - 20.0).abs() < 1e-9);
    // The mean of the angles is 14° from either instead of 10°.
    let half_way = matrix(degrees(90.0, 80.0, 90.0));
    for end in [first, last] {
        assert!((degrees_between(&matrix(end), &half_way) - 14.133).abs() < 1e-3);
    }
    let short = columns(first.orientation().slerp(&last.orientation(), 0.5));
    assert!((degrees_between(&matrix(first), &short) - 10.0).abs() < 1e-9);
    assert!((degrees_between(&matrix(last), &short) - 10.0).abs() < 1e-9);
}

#[test]
fn the_view_matrix_puts_the_eye_at_the_origin_and_its_gaze_along_minus_z() {
    let mut random = Random(2);
    for _ in 0..100_000 {
        let [yaw, pitch, roll] = [(); 3].map(|()| random.between(-PI, PI));
        let eye = [(); 3].map(|()| random.between(-5.0, 5.0));
        let view = angles::<f64>(yaw, pitch, roll)
            .view_matrix(Point3::from(eye))
            .expect("an eye that is somewhere");
        // R T(−eye), element by element: R p − R eye.
        let r = eq_10(yaw, pitch, roll);
        let p = [(); 3].map(|()| random.between(-5.0, 5.0));
        let expected = apply(&r, [0, 1, 2].map(|i| p[i] - eye[i]));
        let seen = view.transform_point(&Point3::from(p));
        assert!((seen.coords - Vector3::from(expected)).norm() < 1e-12);
        assert!(view.transform_point(&Point3::from(eye)).coords.norm() < 1e-12);
        let gaze = apply(&transpose(&r), [0.0, 0.0, -2.0]);
        let ahead = Point3::from([0, 1, 2].map(|i| eye[i] + gaze[i]));
        let ahead = view.transform_point(&ahead).coords;
        assert!((ahead - Vector3::new(0.0, 0.0, -2.0)).norm() < 1e-12);
    }
}

#[test]
fn a_vertex_goes_through_model_view_and_projection_in_this_order() {
    // A camera at (0, 0, 5) turned left by 90° looks along −x; the model is moved to (−10, 1, 5).
    let view = degrees(90.0, 0.0, 0.0).view_matrix(Point3::new(0.0, 0.0, 5.0));
    let view = view.expect("an eye that is somewhere");
    let model = Matrix4::new_translation(&Vector3::new(-10.0, 1.0, 5.0));
    // OpenGL's perspective, 90° high, aspect 2, planes at 1 and 101.
    let (near, far) = (1.0, 101.0);
    let projection = Matrix4::new(
        0.5,
        0.0,
        0.0,
        0.0, //
        0.0,
        1.0,
        0.0,
        0.0, //
        0.0,
        0.0,
        -(far + near) / (far - near),
        -2.0 * far * near / (far - near), //
        0.0,
        0.0,
        -1.0,
        0.0,
    );
    // 2 to the south of the model (+z), which is to the left of a camera that looks west.
    let clip = to_clip_space(&projection, &view, &model, Point3::new(0.0, 0.0, 2.0));
    let depth = 10.0 * 102.0 / 100.0 - 202.0 / 100.0;
    let expected = nalgebra::Vector4::new(-1.0, 1.0, depth, 10.0);
    assert!((clip - expected).norm() < 1e-12, "{clip}");
}

#[test]
fn only_the_direction_of_a_quaternion_has_angles() {
    fn worst<T: RealField + Copy>(decades: f64) -> f64 {
        let (mut random, mut worst) = (Random(3), 0.0_f64);
        for _ in 0..2_000_000 {
            let q = [(); 4].map(|()| random.between(-1.0, 1.0));
            if q.iter().map(|c| c * c).sum::<f64>() < 0.01 {
                continue;
            }
            let length = 10.0_f64.powf(random.between(-decades, decades));
            let [w, x, y, z] = q.map(|c| convert(c * length));
            let found =
                EulerAngles::<T>::of(UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)));
            let [w, x, y, z] = q;
            let unit = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
            worst = worst.max(degrees_between(&matrix(found), &columns(unit)).to_radians());
        }
        worst
    }
    assert!(worst::<f64>(300.0) < 1e-9);
    assert!(worst::<f32>(30.0) < 1e-5);
}

#[test]
fn angles_that_are_none_count_as_zero_and_an_eye_that_is_nowhere_sees_nothing() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (some, none) = (angles::<f64>(0.3, bad, -0.4), angles::<f64>(0.3, 0.0, -0.4));
        assert_eq!(some.orientation(), none.orientation());
        assert_eq!(some.world_to_body(), none.world_to_body());
        assert_eq!(some.rates(AngularRate::zero()), None);
        for eye in [[bad, 0.0, 0.0], [0.0, 1.0, bad], [f64::MAX; 3]] {
            assert_eq!(none.view_matrix(Point3::from(eye)), None, "{eye:?}");
        }
    }
}
