//! One angle (course notes, section 3): eq. 6 to 9, their corners, and how far they go astray.

mod matrices;

mod random;

#[path = "flatland/corners.rs"]
mod corners;

use matrices::larger;
use nalgebra::{RealField, Vector3, convert};
use random::{ODD, Random};
use std::f64::consts::{PI, TAU};
use vrduino::calibration::{GyroBias, Reading};
use vrduino::orientation::TimeConstant;
use vrduino::orientation::flatland::response::Response;
use vrduino::orientation::flatland::{Flatland, error, from_accelerometer, shortest_turn};
use vrduino::sensor::Sample;
use vrduino::sensor::simulation::Gaussian;
use vrduino::units::{Angle, AngularRate, Seconds, SpecificForce};

const G: f64 = 9.81;

fn reading<T: RealField + Copy>(rad_per_s: f64, m_per_s2: [f64; 3]) -> Reading<T> {
    GyroBias::zero().correct(Sample {
        // Only the turn about z is flatland's.
        rate: AngularRate::from_rad_per_s(Vector3::new(5.0, -5.0, rad_per_s).map(convert)),
        force: SpecificForce::from_m_per_s2(Vector3::from(m_per_s2).map(convert)),
    })
}

/// What the accelerometer reads at this angle.
fn tilted(radians: f64) -> [f64; 3] {
    let (sin, cos) = radians.sin_cos();
    [G * sin, G * cos, 3.0]
}

fn about_z(rad_per_s: f64) -> AngularRate<f64> {
    AngularRate::from_rad_per_s(Vector3::new(0.0, 0.0, rad_per_s))
}

fn filter(alpha: f64, dt: f64) -> Flatland<f64> {
    Flatland::new(time_constant(alpha, dt), Seconds(dt))
}

fn time_constant(alpha: f64, dt: f64) -> TimeConstant<f64> {
    TimeConstant::from_gyro_weight(alpha, Seconds(dt))
}

/// Largest deviation from eq. 7 to 9 as printed, for a motion that stays off the seam.
fn deviation_from_the_notes<T: RealField + Copy>() -> f64 {
    let as_f64 = |a: Angle<T>| nalgebra::try_convert::<T, f64>(a.rad()).expect("a real number");
    let mut worst = 0.0_f64;
    for (alpha, dt) in [(0.98, 0.001), (0.9, 0.01), (0.5, 0.01)] {
        let period = Seconds(convert(dt));
        let tau = TimeConstant::from_gyro_weight(convert::<f64, T>(alpha), period);
        let mut flat = Flatland::new(tau, period);
        let (mut gyro, mut fused) = (0.0, 0.0);
        for i in 0..2000 {
            let t = f64::from(i) * dt;
            let (truth, rate) = ((2.0 * t).sin(), 2.0 * (2.0 * t).cos() + 0.01);
            let roll = flat.update(&reading::<T>(rate, tilted(truth)));
            gyro += rate * dt;
            let [x, y, _] = tilted(truth);
            fused = alpha * (fused + rate * dt) + (1.0 - alpha) * x.atan2(y);
            for (is, expected) in [
                (roll.gyro, gyro),
                (roll.accelerometer, truth),
                (roll.fused, fused),
            ] {
                worst = larger(worst, (as_f64(is) - expected).abs());
            }
        }
    }
    worst
}

#[test]
fn flatland_follows_eq_7_to_9() {
    let worst = deviation_from_the_notes::<f64>();
    assert!(worst < 1e-9, "{worst:e}");
}

#[test]
fn flatland_follows_eq_7_to_9_in_single_precision() {
    let worst = deviation_from_the_notes::<f32>();
    assert!(worst < 1e-5, "{worst:e}");
}

#[test]
fn flatland_blends_across_the_seam() {
    // α = 0.9; the gyro stands at 179°, the accelerometer says −179°.
    let (before, now) = (179.0_f64, -179.0_f64);
    let mut flat = filter(0.9, 0.01);
    flat.reset(reading::<f64>(0.0, tilted(before.to_radians())).force());
    let roll = flat.update(&reading(0.0, tilted(now.to_radians())));
    assert!((roll.fused.degrees() - 179.2).abs() < 1e-9);
    assert!((roll.accelerometer.degrees() + 179.0).abs() < 1e-9);
    assert!((roll.gyro.degrees() - 179.0).abs() < 1e-9);
    // Eq. 9 as printed blends the angles themselves.
    let printed = 0.9 * before + 0.1 * now;
    assert!((printed - 143.2).abs() < 1e-9);
}

#[test]
fn the_fused_angle_lies_between_its_two_sources_at_every_angle() {
    // The same blend as unit vectors: independent of seams. The short arc from one to the other.
    let mut random = Random(1);
    for _ in 0..2_000_000 {
        let (start, shown) = (random.between(-PI, PI), random.between(-PI, PI));
        let (alpha, turned) = (random.between(0.0, 1.0), random.between(-0.5, 0.5));
        let mut flat = filter(alpha, 0.01);
        flat.start_at(Angle::from_rad(start));
        let roll = flat.update(&reading(turned / 0.01, tilted(shown)));
        let by_gyro = start + turned;
        let arc = (shown - by_gyro).sin().atan2((shown - by_gyro).cos());
        if arc.abs() > PI - 1e-3 {
            continue; // Opposite: either way is as short.
        }
        let expected = by_gyro + (1.0 - alpha) * arc;
        let fused = roll.fused.rad();
        assert!(fused.abs() <= PI + 1e-15);
        assert!((fused.cos() - expected.cos()).abs() < 1e-9);
        assert!((fused.sin() - expected.sin()).abs() < 1e-9);
    }
}

#[test]
fn the_start_is_the_one_chosen() {
    let mut flat = filter(0.9, 0.01);
    for (start, stands) in [(30.0, 30.0), (-190.0, 170.0), (720.0, 0.0), (f64::NAN, 0.0)] {
        flat.start_at(Angle::from_degrees(start));
        let roll = flat.roll();
        for angle in [roll.gyro, roll.accelerometer, roll.fused] {
            assert!(
                (angle.degrees() - stands).abs() < 1e-9,
                "{start}: {angle:?}"
            );
        }
    }
    // Or the one the accelerometer shows; where it shows none, zero.
    flat.reset(SpecificForce::from_m_per_s2(Vector3::from(tilted(0.7))));
    assert!((flat.roll().gyro.rad() - 0.7).abs() < 1e-12);
    flat.reset(SpecificForce::from_m_per_s2(Vector3::zeros()));
    assert_eq!(flat.roll().gyro.rad(), 0.0);
}

#[test]
fn eq_8_has_an_angle_for_every_force_with_a_direction() {
    let angle = |x, y| from_accelerometer(SpecificForce::from_m_per_s2(Vector3::new(x, y, 1.0)));
    let mut random = Random(2);
    for _ in 0..2_000_000 {
        let truth = random.between(-PI, PI);
        let size = 10.0_f64.powf(random.between(-150.0, 150.0));
        let found = angle(size * truth.sin(), size * truth.cos()).expect("a direction");
        assert!((found.rad() - truth).abs() < 1e-9);
    }
    // The arc tangent of the quotient, eq. 8's other form, has half the circle only.
    let found = angle(1.0, -1.0).expect("a direction").degrees();
    assert!((found - 135.0).abs() < 1e-12);
    assert!(((1.0_f64 / -1.0).atan().to_degrees() + 45.0).abs() < 1e-12);
    // Free fall in the plane, and what is no force at all.
    assert_eq!(angle(0.0, 0.0), None);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(angle(bad, 1.0), None);
        assert_eq!(angle(1.0, bad), None);
    }
}

#[test]
fn a_tilt_of_a_ten_thousandth_is_resolved_in_single_precision() {
    let force = Vector3::new(9.81 * 1e-4_f32, 9.81, 0.0);
    let angle = from_accelerometer(SpecificForce::from_m_per_s2(force)).expect("a direction");
    assert!((angle.rad() - 1e-4).abs() < 1e-10);
}

#[test]
fn a_difference_goes_the_short_way() {
    for (from, to, turn) in [
        (179.0_f64, -179.0, 2.0_f64),
        (-179.0, 179.0, -2.0),
        (10.0, 730.0, 0.0),
    ] {
        let found = shortest_turn(Angle::from_degrees(from), Angle::from_degrees(to));
        assert!((found.degrees() - turn).abs() < 1e-9, "{from} to {to}");
    }
}

#[test]
fn the_two_transfer_functions_sum_to_one() {
    let mut random = Random(3);
    for _ in 0..2_000_000 {
        let alpha = random.between(0.0, 1.0);
        let dt = 10.0_f64.powf(random.between(-4.0, 0.0));
        let hertz = 10.0_f64.powf(random.between(-6.0, 3.0));
        let response = Response::new(time_constant(alpha, dt), Seconds(dt));
        let low = response.low_pass(hertz).expect("finite");
        let high = response.high_pass(hertz).expect("finite");
        assert!((low.re + high.re - 1.0).abs() < 1e-12);
        assert!((low.im + high.im).abs() < 1e-12);
    }
}

#[test]
fn each_passes_what_its_name_says() {
    let response = Response::new(time_constant(0.98, 0.01), Seconds(0.01));
    let gain = |c: Option<nalgebra::Complex<f64>>| c.map(|c| c.re.hypot(c.im)).expect("finite");
    assert!((gain(response.low_pass(0.0)) - 1.0).abs() < 1e-15);
    assert_eq!(gain(response.high_pass(0.0)), 0.0);
    // Half the sample rate: 0.02/1.98 and 1.96/1.98.
    assert!((gain(response.low_pass(50.0)) - 0.02 / 1.98).abs() < 1e-12);
    assert!((gain(response.high_pass(50.0)) - 1.96 / 1.98).abs() < 1e-12);
    // α = 1 never asks the accelerometer, α = 0 never the gyro.
    for hertz in [0.0, 1.0, 50.0] {
        for (alpha, low) in [(1.0, 0.0), (0.0, 1.0)] {
            let response = Response::new(time_constant(alpha, 0.01), Seconds(0.01));
            assert!((gain(response.low_pass(hertz)) - low).abs() < 1e-12);
            assert!((gain(response.high_pass(hertz)) - (1.0 - low)).abs() < 1e-12);
        }
    }
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(response.low_pass(bad), None);
        assert_eq!(response.high_pass(bad), None);
    }
}

#[test]
fn the_filter_answers_an_oscillation_as_its_transfer_functions_say() {
    let (alpha, dt) = (0.95, 0.01);
    let response = Response::new(time_constant(alpha, dt), Seconds(dt));
    for hertz in [0.2, 0.8, 3.0, 20.0] {
        let angle = |k: u32| 0.3 * (TAU * hertz * f64::from(k) * dt).sin();
        // Gyro at rest and the accelerometer swinging, then the other way about.
        for of_gyro in [false, true] {
            let mut flat = filter(alpha, dt);
            let (mut sin, mut cos) = (0.0, 0.0);
            // 500 samples to settle, then whole periods for the Fourier sum.
            for k in 1..=1000 {
                let turned = angle(k) - angle(k - 1);
                let fused = if of_gyro {
                    flat.update(&reading(turned / dt, tilted(0.0))).fused
                } else {
                    flat.update(&reading(0.0, tilted(angle(k)))).fused
                };
                if k > 500 {
                    let phase = TAU * hertz * f64::from(k) * dt;
                    sin += fused.rad() * phase.sin() / 250.0;
                    cos += fused.rad() * phase.cos() / 250.0;
                }
            }
            let expected = if of_gyro {
                response.high_pass(hertz)
            } else {
                response.low_pass(hertz)
            };
            let expected = expected.expect("finite");
            assert!((sin / 0.3 - expected.re).abs() < 1e-9, "{hertz} Hz");
            assert!((cos / 0.3 - expected.im).abs() < 1e-9, "{hertz} Hz");
        }
    }
}

#[test]
fn a_bias_drifts_for_ever_in_the_gyro_and_stops_in_the_filter() {
    // 1 °/s, α = 0.98, 10 ms: 0.49°, for good.
    let (alpha, dt, bias) = (0.98, 0.01, 1.0_f64.to_radians());
    let mut flat = filter(alpha, dt);
    for _ in 0..6000 {
        flat.update(&reading(bias, tilted(0.0)));
    }
    let offset = error::fused_offset(about_z(bias), time_constant(alpha, dt));
    let offset = offset.expect("it stands still");
    assert!((offset.degrees() - 0.49).abs() < 1e-9);
    assert!((flat.roll().fused.degrees() - offset.degrees()).abs() < 1e-9);
    let drift = error::gyro_drift(about_z(bias), Seconds(60.0));
    assert!((drift.degrees() - 60.0).abs() < 1e-9);
    assert!((flat.roll().gyro.degrees() - drift.degrees()).abs() < 1e-9);
    // The gyro alone never stands still.
    for alpha in [1.0, 1.5, f64::NAN] {
        for bias in [bias, 0.0] {
            let gyro_alone = time_constant(alpha, dt);
            assert_eq!(error::fused_offset(about_z(bias), gyro_alone), None);
        }
    }
    let no_bias = about_z(f64::NAN);
    assert_eq!(error::fused_offset(no_bias, time_constant(alpha, dt)), None);
}

/// Eq. 6 over a motion θ(t) with rate ω(t): estimate minus truth at the end.
fn euler(angle: fn(f64) -> f64, rate: fn(f64) -> f64, end: f64, dt: f64) -> f64 {
    let mut flat = filter(1.0, dt);
    flat.start_at(Angle::from_rad(angle(0.0)));
    let steps = (end / dt).round() as u32;
    for k in 0..steps {
        flat.update(&reading(rate(f64::from(k) * dt), [0.0; 3]));
    }
    flat.roll().gyro.rad() - angle(end)
}

#[test]
fn the_integration_error_shrinks_with_the_step_and_not_with_its_square() {
    for (dt, printed) in [(0.02, 0.0141), (0.01, 0.0071), (0.005, 0.0035)] {
        let error = euler(f64::sin, f64::cos, 2.0, dt);
        assert!((error - printed).abs() < 1e-4, "{error}");
        let predicted = error::integration_error(about_z(1.0), about_z(2.0_f64.cos()), Seconds(dt));
        // What is left is of the order Δt² θ''/12.
        assert!((error - predicted.rad()).abs() < dt * dt / 10.0);
    }
    // The notes' claim, “proportional to the squared time step”, holds for a single step.
    let single = |dt| euler(|t| 1.0 - t.cos(), f64::sin, dt, dt).abs();
    assert!((single(0.02) / single(0.01) - 4.0).abs() < 1e-3);
    let whole = |dt| euler(f64::sin, f64::cos, 2.0, dt).abs();
    assert!((whole(0.02) / whole(0.01) - 2.0).abs() < 2e-2);
}

#[test]
fn most_drift_is_bias_and_the_integration_error_is_bounded() {
    // 60° to and fro once a second, at 1 kHz, looked at over a minute.
    let amplitude = PI / 3.0;
    let (dt, mut flat, mut worst) = (0.001, filter(1.0, 0.001), 0.0_f64);
    for k in 0..60_000 {
        let t = f64::from(k) * dt;
        let rate = amplitude * TAU * (TAU * t).cos();
        let angle = flat.update(&reading(rate, [0.0; 3])).gyro.rad();
        worst = larger(worst, (angle - amplitude * (TAU * (t + dt)).sin()).abs());
    }
    assert!((0.37..0.38).contains(&worst.to_degrees()), "{worst}");
    let bias = about_z(0.1_f64.to_radians());
    let drift = error::gyro_drift(bias, Seconds(60.0));
    assert!((drift.degrees() - 6.0).abs() < 1e-9);
}

#[test]
fn fused_is_calmer_than_the_accelerometer_and_truer_than_the_gyro() {
    // Figure 3 in numbers: a minute of nodding, 0.1 °/s of bias, 0.5 m/s² and 0.1 °/s of noise.
    let (dt, mut noise) = (0.01, Gaussian::new(1));
    let mut flat = filter(0.98, dt);
    let mut squares = [0.0; 3];
    for k in 1..=6000 {
        let t = f64::from(k) * dt;
        let (truth, rate) = (0.5 * t.sin(), 0.5 * t.cos());
        let faults = (0.1 + 0.1 * noise.normal()).to_radians();
        let mut force = tilted(truth);
        force[0] += 0.5 * noise.normal();
        force[1] += 0.5 * noise.normal();
        let roll = flat.update(&reading(rate + faults, force));
        for (sum, angle) in squares
            .iter_mut()
            .zip([roll.gyro, roll.accelerometer, roll.fused])
        {
            *sum += (angle.rad() - truth).to_degrees().powi(2) / 6000.0;
        }
    }
    let [gyro, accelerometer, fused] = squares.map(f64::sqrt);
    assert!((3.0..4.0).contains(&gyro), "{gyro}");
    assert!((2.8..3.1).contains(&accelerometer), "{accelerometer}");
    assert!(fused < 0.4, "{fused}");
}
