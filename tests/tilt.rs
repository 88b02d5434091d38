//! The tilt correction of the course notes, section 5.2, points up from anywhere and leaves yaw
//! alone; so does the orientation that the accelerometer alone gives.

mod matrices;

mod random;

mod rotations;

use nalgebra::{Quaternion, RealField, UnitQuaternion, Vector3, convert};
use rotations::{Random, largest_difference, matrix, rotation};
use std::f64::consts::PI;
use vrduino::orientation::complementary::Complementary;
use vrduino::orientation::{TimeConstant, accelerometer, tilt};
use vrduino::units::{Seconds, SpecificForce};

const G: f64 = 9.81;
const DT: f64 = 0.001;

fn force<T: RealField + Copy>(v: [f64; 3]) -> SpecificForce<T> {
    SpecificForce::from_m_per_s2(Vector3::from(v.map(convert::<f64, T>)))
}

#[test]
fn tilt_correction_never_turns_about_the_vertical() {
    let mut random = Random(11);
    for _ in 0..100_000 {
        let force = SpecificForce::from_m_per_s2(Vector3::from(random.vector(20.0)));
        let q = tilt::correction(force, random.unit());
        assert_eq!(q.j, 0.0);
    }
}

#[test]
fn full_correction_points_the_force_up_from_anywhere() {
    let mut random = Random(12);
    for i in 0..100_000 {
        // Near up, near down and everything between, at all scales.
        let mut v = Vector3::from(random.vector(1.0));
        if i % 2 == 0 {
            let spread = 10.0_f64.powf(random.between(-9.0, 0.0));
            v = Vector3::new(v.x * spread, v.y.signum(), v.z * spread);
        }
        let scale = 10.0_f64.powf(random.between(-30.0, 30.0));
        let force = SpecificForce::from_m_per_s2(v * scale);
        let up = tilt::correction(force, 1.0) * v.normalize();
        // The series near level is good to 1e-11.
        assert!((up - Vector3::y()).norm() < 1e-11, "{v:?} {up:?}");
    }
}

#[test]
fn the_corners_the_notes_leave_open_are_closed() {
    let force = |x, y, z| SpecificForce::from_m_per_s2(Vector3::<f64>::new(x, y, z));
    let identity = UnitQuaternion::identity();
    assert_eq!(tilt::correction(force(0.0, G, 0.0), 1.0), identity);
    assert_eq!(tilt::correction(force(0.0, 0.0, 0.0), 1.0), identity);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut v = Vector3::new(0.1, G, 0.2);
            v[axis] = bad;
            let q = tilt::correction(SpecificForce::from_m_per_s2(v), 1.0);
            assert_eq!(q, identity, "{v:?}");
        }
    }
    // Upside down: half a turn about a horizontal axis, in full or in part.
    let half_turn = tilt::correction(force(0.0, -G, 0.0), 1.0);
    assert!((half_turn.angle() - PI).abs() < 1e-12);
    assert_eq!(half_turn.j, 0.0);
    let tenth = tilt::correction(force(0.0, -G, 0.0), 0.1);
    assert!((tenth.angle() - PI / 10.0).abs() < 1e-12);
}

#[test]
fn levelling_what_is_no_orientation_starts_from_the_identity() {
    let force = SpecificForce::from_m_per_s2(Vector3::new(3.0, -1.0, 2.0));
    let expected = tilt::level(UnitQuaternion::identity(), force);
    for bad in [0.0, f64::NAN, f64::INFINITY] {
        let none = UnitQuaternion::new_unchecked(Quaternion::new(bad, bad, 0.0, 0.0));
        assert_eq!(tilt::level(none, force), expected);
    }
    // Of twice the length it is one all the same.
    let long = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 2.0, 0.0, 0.0));
    assert!((tilt::level(long, force).norm() - 1.0).abs() < 1e-12);
}

#[test]
fn levelling_keeps_the_heading() {
    let mut random = Random(13);
    for _ in 0..1000 {
        let yaw = random.between(-PI, PI);
        let (pitch, roll) = (random.between(-1.4, 1.4), random.between(-1.4, 1.4));
        let y = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), yaw);
        let x = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), pitch);
        let z = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), roll);
        let force = SpecificForce::from_m_per_s2((y * x * z).inverse() * Vector3::y() * G);
        let mut filter = Complementary::new(TimeConstant::new(Seconds(7.6)), Seconds(DT));
        filter.set(y);
        filter.level(force);
        let up = filter.orientation() * force.m_per_s2() / G;
        assert!((up - Vector3::y()).norm() < 1e-10);
        // What levelling added is a turn about a horizontal axis.
        assert!((filter.orientation() * y.inverse()).j.abs() < 1e-12);
        filter.reset(force);
        assert!((filter.orientation() * force.m_per_s2() / G - Vector3::y()).norm() < 1e-10);
        assert!(filter.orientation().j.abs() < 1e-12);
    }
}

fn the_accelerometer_alone_levels<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(43);
    for round in 0..2_000_000 {
        let mut up = random.direction();
        if round % 2 == 0 {
            // Near up and near down.
            let spread = 10.0_f64.powf(random.between(-9.0, 0.0));
            up = [up[0] * spread, up[1].signum(), up[2] * spread];
        }
        let scale = 10.0_f64.powf(random.between(-30.0, 30.0));
        let q = accelerometer::orientation::<T>(force(up.map(|c| c * scale))).expect("an up");
        assert!(q.j.is_zero());
        let horizontal = up[0].hypot(up[2]);
        let axis = [-up[2] / horizontal, 0.0, up[0] / horizontal];
        let expected = rotation(axis, horizontal.atan2(up[1]));
        assert!(
            largest_difference(&matrix(&q), &expected) < tolerance,
            "{up:?}"
        );
    }
}

#[test]
fn the_accelerometer_alone_turns_its_force_straight_up() {
    the_accelerometer_alone_levels::<f64>(1e-9);
    the_accelerometer_alone_levels::<f32>(1e-5);
    assert_eq!(accelerometer::orientation::<f64>(force([0.0; 3])), None);
    assert_eq!(
        accelerometer::orientation::<f64>(force([f64::NAN, G, 0.0])),
        None
    );
    let upside_down = accelerometer::orientation::<f64>(force([0.0, -G, 0.0]));
    assert!((upside_down.expect("an up").angle() - PI).abs() < 1e-9);
}

#[test]
fn a_tilt_of_a_ten_thousandth_is_resolved_in_single_precision() {
    for tilt in [1e-6_f32, 1e-4, 3e-4, 1e-2] {
        let leaning = SpecificForce::from_m_per_s2(Vector3::new(tilt.sin(), tilt.cos(), 0.0));
        let q = tilt::correction(leaning, 1.0);
        let turned = 2.0 * q.imag().norm();
        assert!((turned / tilt - 1.0).abs() < 2e-5, "{tilt} {turned}");
    }
    // Eq. 23 as printed, φ = cos⁻¹(v_y): nothing at 1e-4, and 15 % too much at 3e-4.
    assert_eq!(1e-4_f32.cos().acos(), 0.0);
    assert!((3e-4_f32.cos().acos() - 3.45e-4).abs() < 1e-6);
}

/// Eq. 23 as printed: φ and n/|n|.
fn printed_correction(v: [f64; 3]) -> (f64, [f64; 3]) {
    let length = v[0].hypot(v[2]);
    (v[1].acos(), [-v[2] / length, 0.0, v[0] / length])
}

#[test]
fn eq_23_as_printed_has_no_axis_at_the_poles() {
    for (v, angle) in [([0.0, 1.0, 0.0], 0.0), ([0.0, -1.0, 0.0], PI)] {
        assert!(printed_correction(v).1[0].is_nan());
        assert!((tilt::correction::<f64>(force(v), 1.0).angle() - angle).abs() < 1e-9);
    }
    // Elsewhere it is the library's.
    let mut random = Random(45);
    for _ in 0..100_000 {
        let v = random.direction();
        let (phi, axis) = printed_correction(v);
        let made = matrix(&tilt::correction::<f64>(force(v), 1.0));
        assert!(largest_difference(&made, &rotation(axis, phi)) < 1e-7);
    }
}

#[test]
fn eq_22_is_about_directions() {
    // As printed it turns a force of 9.81 m/s² into a vector of length 1.
    let mut random = Random(46);
    for _ in 0..100_000 {
        let a = random.direction().map(|c| c * G);
        let turned = tilt::correction::<f64>(force(a), 1.0) * Vector3::from(a);
        assert!((turned - Vector3::y()).norm() > 8.8);
        assert!((turned / G - Vector3::y()).norm() < 1e-10);
    }
}

#[test]
fn v_cross_up_is_as_long_as_the_sine_of_the_tilt() {
    // The 2016 lecture equates v × (0, 1, 0) with the same vector normalised.
    for phi in [0.1_f64, 1.0, 2.0] {
        let v = Vector3::new(phi.sin() * 0.6, phi.cos(), phi.sin() * 0.8);
        let n = v.cross(&Vector3::y());
        assert!((n - Vector3::new(-v.z, 0.0, v.x)).norm() < 1e-15);
        assert!((n.norm() - phi.sin()).abs() < 1e-12);
    }
}
