//! Tracking with quaternions follows the course notes, section 5, and no input makes it return
//! anything but a rotation. Forms that are printed and wrong stand here beside the library's.

mod matrices;

mod random;

mod rotations;

use nalgebra::{Quaternion, RealField, UnitQuaternion, Vector3, convert};
use rotations::{
    IDENTITY, Random, angle_between, anything, apply, assert_is_a_rotation, exponential,
    gyro as notes_step, larger, largest_difference, matrix, product, random_quaternion, reading,
    rotation, tilt as notes_tilt, times, transpose, unit_quaternion,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use vrduino::orientation::complementary::Complementary;
use vrduino::orientation::gyro::DeadReckoning;
use vrduino::orientation::{DEFAULT_TIME_CONSTANT, TimeConstant, accelerometer, tilt};
use vrduino::units::{Seconds, SpecificForce};

const G: f64 = 9.81;
const DT: f64 = 0.001;

/// A few seconds of random turning about all axes, with the forces a board would feel.
fn motion(seed: u64, fastest_rad_per_s: f64) -> Vec<([f64; 3], [f64; 3])> {
    let mut random = Random(seed * 2 + 1);
    let parts: Vec<_> = (0..4)
        .map(|_| {
            let size = random.vector(fastest_rad_per_s / 4.0);
            (size, random.between(0.1, 3.0), random.between(0.0, TAU))
        })
        .collect();
    let mut truth = rotation([0.6, 0.0, 0.8], random.between(0.0, PI));
    (0..5000)
        .map(|i| {
            let t = f64::from(i) * DT;
            let mut rate = [0.0; 3];
            for (size, hertz, phase) in &parts {
                for axis in 0..3 {
                    rate[axis] += size[axis] * (TAU * hertz * t + phase).sin();
                }
            }
            truth = notes_step(&truth, rate, DT);
            let mut force = apply(&transpose(&truth), [0.0, G, 0.0]);
            for (axis, noise) in random.vector(2.0).into_iter().enumerate() {
                force[axis] += noise;
                rate[axis] += 0.01;
            }
            (rate, force)
        })
        .collect()
}

/// Largest difference of any element of the rotation matrix over many motions.
fn deviation_from_the_notes<T: RealField + Copy>() -> f64 {
    let mut worst = 0.0_f64;
    // The default, one in between, and the course's α = 0.9 at 1 kHz.
    for tau in [7.6, 0.5, 0.009] {
        for seed in 0..20 {
            let fastest = [1.0, 5.0, 20.0, 60.0][seed as usize % 4];
            let time_constant = TimeConstant::new(Seconds(convert::<f64, T>(tau)));
            let mut filter = Complementary::new(time_constant, Seconds(convert::<f64, T>(DT)));
            let mut expected = IDENTITY;
            for (rate, force) in motion(seed, fastest) {
                let q = filter.update(&reading::<T>(rate, force));
                assert_is_a_rotation(&q, 2e-6);
                let by_gyro = notes_step(&expected, rate, DT);
                expected = notes_tilt(&by_gyro, force, DT / (tau + DT));
                worst = larger(worst, largest_difference(&matrix(&q), &expected));
            }
        }
    }
    worst
}

#[test]
fn in_double_precision_the_filter_is_that_of_the_notes() {
    let worst = deviation_from_the_notes::<f64>();
    assert!(worst < 1e-9, "{worst:e}");
}

#[test]
fn in_single_precision_the_filter_stays_within_a_hundredth_of_a_degree() {
    let worst = deviation_from_the_notes::<f32>();
    assert!(worst < 0.01_f64.to_radians(), "{worst:e}");
}

#[test]
fn dead_reckoning_is_that_of_the_notes() {
    for seed in 0..10 {
        let mut gyro = DeadReckoning::new(Seconds(DT));
        let mut expected = IDENTITY;
        for (rate, force) in motion(seed, 30.0) {
            let q = gyro.update(&reading::<f64>(rate, force));
            expected = notes_step(&expected, rate, DT);
            assert!(largest_difference(&matrix(&q), &expected) < 1e-9);
        }
    }
}

#[test]
fn steps_of_any_size_are_exact() {
    // From a thousandth of a degree to three turns in one sample.
    for exponent in -50..=12 {
        let angle = 2.0_f64.powf(f64::from(exponent) / 4.0);
        for axis in [[1.0, 0.0, 0.0], [0.6, 0.0, -0.8], [0.48, 0.6, 0.64]] {
            let mut gyro = DeadReckoning::new(Seconds(1.0));
            let q = gyro.update(&reading::<f64>(axis.map(|a| a * angle), [0.0, G, 0.0]));
            let expected = rotation(axis, angle);
            let difference = largest_difference(&matrix(&q), &expected);
            assert!(difference < 1e-13, "{angle}: {difference:e}");
        }
    }
}

#[test]
fn quarter_turns_go_the_right_way() {
    // With the world's y up: pitch up lifts −z, yaw left turns −z to −x, roll left drops −x.
    let cases = [
        ([FRAC_PI_2, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]),
        ([0.0, FRAC_PI_2, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]),
        ([0.0, 0.0, FRAC_PI_2], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]),
    ];
    for (rate, body, world) in cases {
        let mut gyro = DeadReckoning::new(Seconds(DT));
        for _ in 0..1000 {
            gyro.update(&reading::<f64>(rate, [0.0; 3]));
        }
        let turned = gyro.orientation() * Vector3::from(body);
        assert!((turned - Vector3::from(world)).norm() < 1e-12);
    }
}

#[test]
fn the_turn_is_about_the_axes_of_the_body() {
    // Pitch up a quarter turn, then yaw: the body's y now points back along the world's z.
    let mut gyro = DeadReckoning::new(Seconds(1.0));
    gyro.update(&reading::<f64>([FRAC_PI_2, 0.0, 0.0], [0.0; 3]));
    let q = gyro.update(&reading::<f64>([0.0, FRAC_PI_2, 0.0], [0.0; 3]));
    let expected = Quaternion::new(0.5, 0.5, 0.5, 0.5);
    assert!((q.into_inner() - expected).norm() < 1e-12);
}

#[test]
fn an_error_of_tilt_decays_to_one_part_in_e_in_the_time_constant() {
    for tau in [0.1, 1.0, 7.6] {
        let mut filter = Complementary::new(TimeConstant::new(Seconds(tau)), Seconds(DT));
        let start = 0.3;
        filter.set(UnitQuaternion::from_axis_angle(&Vector3::z_axis(), start));
        for _ in 0..(tau / DT).round() as u32 {
            filter.update(&reading::<f64>([0.0; 3], [0.0, G, 0.0]));
        }
        let left = filter.orientation().angle() / start;
        assert!((left - (-1.0_f64).exp()).abs() < 0.5 * DT / tau, "{left}");
    }
}

#[test]
fn weight_and_time_constant_say_the_same() {
    let tau = TimeConstant::from_gyro_weight(0.9, Seconds(DT));
    assert!((tau.time().0 - 0.009_f64).abs() < 1e-12);
    assert!((tau.accelerometer_weight(Seconds(DT)) - 0.1).abs() < 1e-12);
    assert!((tau.gyro_weight(Seconds(DT)) - 0.9).abs() < 1e-12);
    assert_eq!(DEFAULT_TIME_CONSTANT.time(), Seconds(7.6));
}

#[test]
fn a_board_turned_upside_down_is_found_again() {
    let mut filter = Complementary::new(TimeConstant::new(Seconds(0.1_f32)), Seconds(0.001));
    for _ in 0..3000 {
        filter.update(&reading::<f32>([0.0; 3], [0.0, -G, 0.0]));
    }
    let up = filter.orientation() * -Vector3::y();
    assert!((up - Vector3::y()).norm() < 1e-5, "{up:?}");
}

fn survives_anything<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(14);
    for round in 0..100 {
        let (tau, dt) = times::<T>(round, &mut random);
        let mut filter = Complementary::new(tau, dt);
        let mut gyro = DeadReckoning::new(dt);
        for _ in 0..1000 {
            let rate = [(); 3].map(|()| anything(&mut random));
            let force = [(); 3].map(|()| anything(&mut random));
            let reading = reading::<T>(rate, force);
            assert_is_a_rotation(&filter.update(&reading), tolerance);
            assert_is_a_rotation(&gyro.update(&reading), tolerance);
            if let Some(q) = accelerometer::orientation(reading.force()) {
                assert_is_a_rotation(&q, tolerance);
            }
            if random.unit() < 0.01 {
                filter.level(reading.force());
                assert_is_a_rotation(&filter.orientation(), tolerance);
                filter.reset(reading.force());
                assert_is_a_rotation(&filter.orientation(), tolerance);
                let [x, y, z] = rate.map(convert::<f64, T>);
                let bad = Quaternion::new(tau.time().0, x, y, z);
                gyro.set(UnitQuaternion::new_unchecked(bad));
                assert_is_a_rotation(&gyro.orientation(), tolerance);
            }
        }
    }
}

#[test]
fn no_input_makes_anything_but_a_rotation() {
    survives_anything::<f32>(1e-6);
    survives_anything::<f64>(1e-10);
}

fn one_step_is_exact<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(41);
    for _ in 0..500_000 {
        let (w, period) = (random.vector(35.0), random.between(0.0, 0.1));
        let mut gyro = DeadReckoning::new(Seconds(convert::<f64, T>(period)));
        let q = gyro.update(&reading(w, [0.0; 3]));
        let expected = exponential(w.map(|w| w * period));
        assert!(largest_difference(&matrix(&q), &expected) < tolerance);
    }
}

#[test]
fn one_step_is_the_matrix_exponential_of_the_rate() {
    one_step_is_exact::<f64>(1e-9);
    one_step_is_exact::<f32>(1e-5);
    // “Make sure not to divide by 0” (lecture 2016): no turn is the identity.
    let mut gyro = DeadReckoning::new(Seconds(DT));
    let q = gyro.update(&reading::<f64>([0.0; 3], [0.0; 3]));
    assert_eq!(q, UnitQuaternion::identity());
}

fn force<T: RealField + Copy>(v: [f64; 3]) -> SpecificForce<T> {
    SpecificForce::from_m_per_s2(Vector3::from(v.map(convert::<f64, T>)))
}

fn one_update_is_exact<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(44);
    for _ in 0..200_000 {
        let (start, alpha) = (random_quaternion(&mut random), random.unit());
        let (w, a) = (random.vector(5.0), random.vector(10.0));
        let c = convert::<f64, T>;
        let tau = TimeConstant::from_gyro_weight(c(alpha), Seconds(c(DT)));
        let mut filter = Complementary::new(tau, Seconds(c(DT)));
        filter.set(unit_quaternion(start));
        let by_gyro = notes_step(&matrix(&unit_quaternion::<f64>(start)), w, DT);
        let [x, y, z] = apply(&by_gyro, a);
        // Within 6° of upside down the axis hangs on the last digits of the force: single precision has
        // 1e-5 there no more.
        if y < 0.0 && x.hypot(z) < -0.1 * y {
            continue;
        }
        let q = filter.update(&reading(w, a));
        let expected = notes_tilt(&by_gyro, a, 1.0 - alpha);
        let off = largest_difference(&matrix(&q), &expected);
        assert!(off < tolerance, "{off}: {start:?} {alpha} {w:?} {a:?}");
    }
}

#[test]
fn one_update_of_the_filter_is_eq_24() {
    one_update_is_exact::<f64>(1e-9);
    one_update_is_exact::<f32>(1e-5);
}

#[test]
fn what_is_not_finite_turns_nothing_and_corrects_nothing() {
    let (rate, up) = ([0.3, -0.2, 0.5], [1.0, 9.0, -2.0]);
    let tau = TimeConstant::from_gyro_weight(0.9, Seconds(DT));
    let updated = |rate, force| {
        let mut filter = Complementary::new(tau, Seconds(DT));
        filter.set(unit_quaternion::<f64>([0.5, -0.5, 0.5, 0.5]));
        let start = matrix(&filter.orientation());
        (start, matrix(&filter.update(&reading(rate, force))))
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut bad_rate, mut bad_force) = (rate, up);
            (bad_rate[axis], bad_force[axis]) = (bad, bad);
            let (start, q) = updated(bad_rate, up);
            assert!(largest_difference(&q, &notes_tilt(&start, up, 0.1)) < 1e-9);
            let (start, q) = updated(rate, bad_force);
            assert!(largest_difference(&q, &notes_step(&start, rate, DT)) < 1e-9);
            let (start, q) = updated(bad_rate, bad_force);
            assert!(largest_difference(&q, &start) < 1e-15);
        }
    }
    let (start, q) = updated(rate, [0.0; 3]);
    assert!(largest_difference(&q, &notes_step(&start, rate, DT)) < 1e-9);
}

#[test]
fn the_error_of_integration_goes_with_the_time_step_not_with_its_square() {
    // Two seconds of coning, with the rate held over every step: R = Rz(3t) Rx(sin 2t) has this
    // rate in the body.
    let truth = |t: f64| {
        let tip = rotation([1.0, 0.0, 0.0], (2.0 * t).sin());
        product(&rotation([0.0, 0.0, 1.0], 3.0 * t), &tip)
    };
    let rate = |t: f64| {
        let tip = (2.0 * t).sin();
        [2.0 * (2.0 * t).cos(), 3.0 * tip.sin(), 3.0 * tip.cos()]
    };
    let error = |dt: f64| {
        let mut gyro = DeadReckoning::new(Seconds(dt));
        for i in 0..(2.0 / dt).round() as u32 {
            gyro.update(&reading(rate(f64::from(i) * dt), [0.0; 3]));
        }
        angle_between(&truth(2.0), &matrix(&gyro.orientation()))
    };
    let errors = [0.02, 0.01, 0.005, 0.0025].map(error);
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((ratio - 2.0).abs() < 0.05, "{errors:?}");
    }
    for (error, expected) in errors.iter().zip([0.0329, 0.0164, 0.0082, 0.0041]) {
        assert!((error - expected).abs() < 1e-4, "{errors:?}");
    }
}

#[test]
fn quaternions_pass_where_adding_up_angles_does_not() {
    // Rolled by 90°, then 90°/s about the body's x for a second: the world sees a turn about y.
    let mut gyro = DeadReckoning::new(Seconds(DT));
    gyro.set(UnitQuaternion::from_axis_angle(
        &Vector3::z_axis(),
        FRAC_PI_2,
    ));
    for _ in 0..1000 {
        gyro.update(&reading([FRAC_PI_2, 0.0, 0.0], [0.0; 3]));
    }
    let q = matrix(&gyro.orientation());
    let roll = rotation([0.0, 0.0, 1.0], FRAC_PI_2);
    let yawed = product(&rotation([0.0, 1.0, 0.0], FRAC_PI_2), &roll);
    assert!(angle_between(&q, &yawed) < 1e-9);
    // As the 2016 lecture has it, θ_x grew by 90° and that is all: 120° off.
    let added = product(&rotation([1.0, 0.0, 0.0], FRAC_PI_2), &roll);
    assert!((angle_between(&yawed, &added).to_degrees() - 120.0).abs() < 1e-9);
}

#[test]
fn a_vector_of_the_body_is_seen_from_the_world() {
    // Eq. 19, and eq. 20 and 21 for the force.
    let mut random = Random(42);
    for _ in 0..100_000 {
        let (w, u) = (random.vector(3.0), random.vector(10.0));
        let mut gyro = DeadReckoning::new(Seconds(0.5));
        gyro.update(&reading(w, [0.0; 3]));
        let q = gyro.update(&reading(w, [0.0; 3]));
        let expected = Vector3::from(apply(&exponential(w), u));
        assert!((q * Vector3::from(u) - expected).norm() < 1e-9);
        let seen = tilt::in_world(q, force(u)).m_per_s2();
        assert!((seen - expected).norm() < 1e-9);
    }
}

#[test]
fn figure_7_the_accelerometer_alone_has_no_yaw_and_the_filter_has() {
    // A second of turning by 80° of yaw with a tilt that comes and goes.
    let truth = |t: f64| {
        let tip = rotation([0.6, 0.0, 0.8], 0.5 * (TAU * t).sin());
        product(&rotation([0.0, 1.0, 0.0], 80.0_f64.to_radians() * t), &tip)
    };
    let mut filter = Complementary::new(TimeConstant::new(Seconds(7.6)), Seconds(DT));
    for i in 0..1000 {
        let (from, to) = (truth(f64::from(i) * DT), truth(f64::from(i + 1) * DT));
        let turn = product(&transpose(&from), &to);
        let rate = [
            turn[2][1] - turn[1][2],
            turn[0][2] - turn[2][0],
            turn[1][0] - turn[0][1],
        ];
        let up = apply(&transpose(&to), [0.0, G, 0.0]);
        filter.update(&reading(rate.map(|d| d / 2.0 / DT), up));
    }
    let end = truth(1.0);
    let up = apply(&transpose(&end), [0.0, G, 0.0]);
    let alone = accelerometer::orientation(force(up)).expect("an up");
    let off = |q: &UnitQuaternion<f64>| angle_between(&matrix(q), &end).to_degrees();
    assert!((off(&alone) - 80.0).abs() < 1e-6, "{}", off(&alone));
    assert!(
        off(&filter.orientation()) < 0.01,
        "{}",
        off(&filter.orientation())
    );
}

#[test]
fn tilt_is_taken_after_the_step_of_the_gyro() {
    // All of the tilt at once (α = 0) while the board tips by 10° in one step.
    let (step, up) = (
        10.0_f64.to_radians(),
        rotation([1.0, 0.0, 0.0], 10.0_f64.to_radians()),
    );
    let force_now = apply(&transpose(&up), [0.0, G, 0.0]);
    let mut filter = Complementary::new(
        TimeConstant::from_gyro_weight(0.0, Seconds(DT)),
        Seconds(DT),
    );
    let q = filter.update(&reading([step / DT, 0.0, 0.0], force_now));
    assert!(angle_between(&matrix(&q), &up) < 1e-9);
    // The 2016 lecture rotates the force by q(t) and corrects q(t+Δt): 10° stay.
    let from_before = notes_tilt(&IDENTITY, force_now, 1.0);
    let printed = product(
        &from_before,
        &notes_step(&IDENTITY, [step / DT, 0.0, 0.0], DT),
    );
    assert!((angle_between(&printed, &up).to_degrees() - 10.0).abs() < 1e-9);
}

#[test]
fn alpha_is_the_weight_of_the_gyro() {
    let leaning = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.3);
    let left_after_one_sample = |alpha: f64| {
        let tau = TimeConstant::from_gyro_weight(alpha, Seconds(DT));
        let mut filter = Complementary::new(tau, Seconds(DT));
        filter.set(leaning);
        filter.update(&reading([0.0; 3], [0.0, G, 0.0])).angle() / 0.3
    };
    // With α = 1 there is no correction, where eq. 24's sentence has the most.
    for alpha in [0.0, 0.25, 0.9, 0.999, 1.0] {
        assert!(
            (left_after_one_sample(alpha) - alpha).abs() < 1e-9,
            "{alpha}"
        );
    }
    for (bad, taken) in [
        (f64::NEG_INFINITY, 0.0),
        (-0.5, 0.0),
        (1.5, 1.0),
        (f64::NAN, 1.0),
        (f64::INFINITY, 1.0),
    ] {
        assert!((left_after_one_sample(bad) - taken).abs() < 1e-9, "{bad}");
    }
}
