//! Pitch and roll from the accelerometer (course notes, eq. 10 to 12; both lectures).

mod matrices;

mod random;

use matrices::larger;
use nalgebra::{RealField, UnitQuaternion, Vector3, convert};
use random::Random;
use std::f64::consts::{FRAC_PI_2, PI};
use vrduino::orientation::angles::{
    PitchRoll, full_pitch_and_roll, pitch_and_roll, pitch_full_circle, pitch_half_circle,
};
use vrduino::units::{Angle, SpecificForce};

const G: f64 = 9.81;

impl Random {
    /// Of any direction and of a length from 1 to 100.
    fn force(&mut self) -> [f64; 3] {
        loop {
            let v = [(); 3].map(|()| self.between(-1.0, 1.0));
            let squared = v.iter().map(|c| c * c).sum::<f64>();
            if (0.01..1.0).contains(&squared) {
                let length = self.between(1.0, 100.0) / squared.sqrt();
                return v.map(|c| c * length);
            }
        }
    }
}

fn force<T: RealField + Copy>(m_per_s2: [f64; 3]) -> SpecificForce<T> {
    SpecificForce::from_m_per_s2(Vector3::from(m_per_s2).map(convert))
}

/// The vector of eq. 10, each element written out.
fn eq_10(pitch: f64, roll: f64) -> [f64; 3] {
    [
        -(-pitch).cos() * (-roll).sin(),
        (-pitch).cos() * (-roll).cos(),
        (-pitch).sin(),
    ]
}

/// Eq. 11 as printed; the sign function of most languages has sign(0) = 0.
fn printed_pitch([x, y, z]: [f64; 3]) -> f64 {
    let sign = if y == 0.0 { 0.0 } else { y.signum() };
    -z.atan2(sign * (x * x + y * y).sqrt())
}

/// Eq. 12 as printed.
fn printed_roll([x, y, _]: [f64; 3]) -> f64 {
    -(-x).atan2(y)
}

/// How far the vector of eq. 10 is from the direction measured.
fn rebuilding_error([pitch, roll]: [f64; 2], a: [f64; 3]) -> f64 {
    let length = a.iter().map(|c| c * c).sum::<f64>().sqrt();
    let rebuilt = eq_10(pitch, roll);
    let differences = (0..3).map(|i| (rebuilt[i] - a[i] / length).abs());
    differences.fold(0.0, larger)
}

fn radians<T: RealField + Copy>(tilt: PitchRoll<T>) -> [f64; 2] {
    let as_f64 = |angle: Angle<T>| nalgebra::try_convert::<T, f64>(angle.rad());
    [tilt.pitch, tilt.roll].map(|angle| as_f64(angle).expect("a real number"))
}

fn both_pairs_rebuild_the_force<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(1);
    for _ in 0..2_000_000 {
        let a = random.force();
        let [pitch, roll] = radians(pitch_and_roll(force::<T>(a)));
        assert!(pitch.abs() <= FRAC_PI_2 + 1e-7 && roll.abs() <= PI + 1e-6);
        assert!(rebuilding_error([pitch, roll], a) < tolerance, "{a:?}");
        let [pitch, roll] = radians(full_pitch_and_roll(force::<T>(a)));
        assert!(pitch.abs() <= PI + 1e-6 && roll.abs() <= FRAC_PI_2 + 1e-7);
        assert!(rebuilding_error([pitch, roll], a) < tolerance, "{a:?}");
    }
}

#[test]
fn both_pairs_rebuild_the_force_everywhere() {
    both_pairs_rebuild_the_force::<f64>(1e-12);
}

#[test]
fn both_pairs_rebuild_the_force_in_single_precision() {
    both_pairs_rebuild_the_force::<f32>(1e-6);
}

#[test]
fn eq_11_and_12_as_printed_describe_another_board_over_half_the_sphere() {
    // Pitch 10°, roll 170°: printed (170°, 170°), which is (−a_x, −a_y, a_z).
    let a = eq_10(10.0_f64.to_radians(), 170.0_f64.to_radians());
    let printed = [printed_pitch(a), printed_roll(a)];
    assert!((printed[0].to_degrees() - 170.0).abs() < 1e-9);
    assert!((printed[1].to_degrees() - 170.0).abs() < 1e-9);
    let rebuilt = eq_10(printed[0], printed[1]);
    for (is, expected) in rebuilt.iter().zip([-a[0], -a[1], a[2]]) {
        assert!((is - expected).abs() < 1e-12);
    }
    let corrected = radians(pitch_and_roll(force::<f64>(a)));
    assert!((corrected[0].to_degrees() - 10.0).abs() < 1e-9);
    assert!((corrected[1].to_degrees() - 170.0).abs() < 1e-9);
    // Every a_y < 0, and none with a_y > 0; at worst a whole diameter.
    let mut random = Random(2);
    let mut worst = 0.0_f64;
    for _ in 0..2_000_000 {
        let a = random.force();
        let error = rebuilding_error([printed_pitch(a), printed_roll(a)], a);
        let across = a[0].hypot(a[1]) / (a[0].hypot(a[1])).hypot(a[2]);
        if a[1] > 0.0 {
            assert!(error < 1e-12);
        } else {
            assert!(error > across, "{a:?}: {error}");
        }
        worst = larger(worst, error);
    }
    assert!(worst > 1.99, "{worst}");
}

#[test]
fn each_pitch_is_the_formula_of_its_document() {
    let mut random = Random(3);
    for _ in 0..2_000_000 {
        let a = random.force();
        let [x, y, z] = a;
        // 2016 lecture, first form.
        let half = -z.atan2((x * x + y * y).sqrt());
        assert!((pitch_half_circle(force::<f64>(a)).rad() - half).abs() < 1e-12);
        // Eq. 11.
        let full = printed_pitch(a);
        assert!((pitch_full_circle(force::<f64>(a)).rad() - full).abs() < 1e-12);
        assert!((radians(pitch_and_roll(force::<f64>(a)))[1] - printed_roll(a)).abs() < 1e-12);
    }
}

#[test]
fn the_arc_sine_of_the_notes_is_ambiguous_and_the_full_circle_is_not() {
    // Pitch 30° and 150° without roll: one a_z.
    let (near, far) = (30.0_f64.to_radians(), 150.0_f64.to_radians());
    let (a, b) = (eq_10(near, 0.0), eq_10(far, 0.0));
    assert!((a[2] - b[2]).abs() < 1e-15);
    assert!((-a[2].asin() - near).abs() < 1e-12 && (-b[2].asin() - near).abs() < 1e-12);
    assert!((pitch_full_circle(force::<f64>(a)).rad() - near).abs() < 1e-12);
    assert!((pitch_full_circle(force::<f64>(b)).rad() - far).abs() < 1e-12);
    // Eq. 11 between its two ends: the quotient is tan(−θ_x) only where cos θ_x > 0.
    let quotient = |a: [f64; 3]| a[2] / a[0].hypot(a[1]);
    assert!((quotient(a) - (-near).tan()).abs() < 1e-12);
    assert!((quotient(b) + (-far).tan()).abs() < 1e-12);
    // The 2016 lecture's first form gives the arc sine's angle.
    assert!((pitch_half_circle(force::<f64>(b)).rad() - near).abs() < 1e-12);
}

#[test]
fn the_sign_of_zero_is_plus_one() {
    // a_y = 0: printed, every pitch is ±90°.
    let a = [0.6, 0.0, 0.8];
    assert!((printed_pitch(a).to_degrees() + 90.0).abs() < 1e-12);
    for a_y in [0.0, -0.0] {
        let a = [0.6, a_y, 0.8];
        let pitch = pitch_full_circle(force::<f64>(a)).degrees();
        assert!((pitch + 53.130_102_354_155_98).abs() < 1e-9);
        for pair in [pitch_and_roll::<f64>, full_pitch_and_roll] {
            assert!(rebuilding_error(radians(pair(force(a))), a) < 1e-12);
        }
    }
}

#[test]
fn eq_10_has_pitch_about_x_and_roll_about_z_and_no_yaw() {
    // The text has pitch about z and roll about x. R_x(30°): a_z changes.
    let tilt = |pitch, roll| PitchRoll {
        pitch: Angle::from_degrees(pitch),
        roll: Angle::from_degrees(roll),
    };
    let a = tilt(30.0, 0.0).up_in_body();
    assert!((a - Vector3::new(0.0, 0.75_f64.sqrt(), -0.5)).norm() < 1e-12);
    let a = tilt(0.0, 30.0).up_in_body();
    assert!((a - Vector3::new(0.5, 0.75_f64.sqrt(), 0.0)).norm() < 1e-12);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(tilt(bad, 30.0).up_in_body(), tilt(0.0, 30.0).up_in_body());
        assert_eq!(tilt(30.0, bad).up_in_body(), tilt(30.0, 0.0).up_in_body());
    }
    let about = |axis, angle: f64| UnitQuaternion::from_axis_angle(&axis, angle);
    let mut random = Random(4);
    for _ in 0..100_000 {
        let [yaw, pitch, roll] = [(); 3].map(|()| random.between(-PI, PI));
        let board = about(Vector3::y_axis(), yaw)
            * about(Vector3::x_axis(), pitch)
            * about(Vector3::z_axis(), roll);
        let up = board.inverse() * Vector3::y();
        let formula = tilt(pitch.to_degrees(), roll.to_degrees()).up_in_body();
        assert!((up - formula).norm() < 1e-12);
        assert!((up - Vector3::from(eq_10(pitch, roll))).norm() < 1e-12);
    }
}

#[test]
fn an_angle_that_is_not_finite_counts_as_zero() {
    let up = |pitch, roll| {
        let [pitch, roll] = [pitch, roll].map(Angle::from_rad);
        PitchRoll { pitch, roll }.up_in_body()
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!((up(bad, 0.3) - Vector3::from(eq_10(0.0, 0.3))).norm() < 1e-15);
        assert!((up(0.3, bad) - Vector3::from(eq_10(0.3, 0.0))).norm() < 1e-15);
        assert_eq!(up(bad, bad), Vector3::y());
    }
}

#[test]
fn pitch_and_roll_are_those_of_the_orientation() {
    let (pitch, roll) = (10.0_f64.to_radians(), 170.0_f64.to_radians());
    let x = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), pitch);
    let z = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), roll);
    let a = (x * z).inverse() * Vector3::y();
    let tilt = pitch_and_roll(SpecificForce::from_m_per_s2(a * G));
    assert!((tilt.pitch.degrees() - 10.0).abs() < 1e-9);
    assert!((tilt.roll.degrees() - 170.0).abs() < 1e-9);
}

#[test]
fn a_tilt_of_a_ten_thousandth_is_resolved_in_single_precision() {
    for tilt in [1e-4, -1e-4, 3e-4, 1e-6] {
        for pair in [pitch_and_roll::<f32>, full_pitch_and_roll] {
            let [pitch, roll] = radians(pair(force(eq_10(tilt, 0.0).map(|c| c * G))));
            assert!((pitch / tilt - 1.0).abs() < 1e-6 && roll == 0.0);
            let [pitch, roll] = radians(pair(force(eq_10(0.0, tilt).map(|c| c * G))));
            assert!((roll / tilt - 1.0).abs() < 1e-6 && pitch == 0.0);
        }
    }
}

#[test]
fn straight_up_and_down_have_no_roll_and_upside_down_has_half_a_turn() {
    for zero in [0.0, -0.0] {
        for (a, pitch) in [([zero, zero, -G], 90.0), ([zero, -zero, G], -90.0)] {
            for pair in [pitch_and_roll::<f64>, full_pitch_and_roll] {
                let tilt = radians(pair(force(a))).map(f64::to_degrees);
                assert!(
                    (tilt[0] - pitch).abs() < 1e-12 && tilt[1] == 0.0,
                    "{a:?} {tilt:?}"
                );
            }
        }
        let down = [zero, -G, 0.0];
        assert!(rebuilding_error(radians(pitch_and_roll(force::<f64>(down))), down) < 1e-12);
        assert!(rebuilding_error(radians(full_pitch_and_roll(force::<f64>(down))), down) < 1e-12);
    }
}

fn no_input_makes_anything_but_angles<T: RealField + Copy>() {
    let max = f64::from(f32::MAX);
    let tiny = f64::from(f32::from_bits(1));
    let odd = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        max,
        -max,
        tiny,
        -tiny,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
    ];
    for x in odd {
        for y in odd {
            for z in odd {
                let a = [x, y, z];
                for pair in [pitch_and_roll::<T>, full_pitch_and_roll] {
                    let tilt = radians(pair(force(a)));
                    if a.iter().all(|c| c.is_finite()) && a != [0.0; 3] {
                        // No overflow and no loss at either end.
                        let largest = a.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
                        assert!(
                            rebuilding_error(tilt, a.map(|c| c / largest)) < 1e-6,
                            "{a:?}"
                        );
                    } else {
                        assert_eq!(tilt, [0.0; 2], "{a:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn no_input_makes_anything_but_angles_in_single_precision() {
    no_input_makes_anything_but_angles::<f32>();
}

#[test]
fn no_input_makes_anything_but_angles_in_double_precision() {
    no_input_makes_anything_but_angles::<f64>();
}
