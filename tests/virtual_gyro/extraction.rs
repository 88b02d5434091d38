//! Section 3.2, figure 4 and figure 7: the three filters in a row.

use crate::reference::*;
use nalgebra::Vector3;
use std::f64::consts::TAU;
use vrduino::virtual_gyro::butterworth::CutOff;
use vrduino::virtual_gyro::{Fields, GravityExtraction, NoAttitude};

#[test]
fn both_fields_stay_in_phase_whatever_the_cut_off_does() {
    let mut random = Random(1);
    let mut extraction = GravityExtraction::<f64, 5, 4>::new();
    let mut opened = false;
    for k in 0..20_000 {
        let v = Vector3::new(0.0, 0.0, 9.81)
            + vector(random.vector(if k % 500 < 50 { 9.0 } else { 0.1 }));
        let sample = Fields {
            gravity: v,
            magnetic: v,
        };
        let found = extraction.update(sample).unwrap();
        assert_eq!(found.is_some(), k >= 5 + 4 - 2);
        if let Some(found) = found {
            assert_eq!(found.gravity, found.magnetic);
        }
        opened |= extraction.adaptive_cut_off().unwrap().fraction() > 0.35;
    }
    assert!(opened, "the cut-off never moved");
}

#[test]
fn a_fixed_delay_of_n_minus_1_puts_the_magnetic_field_out_of_phase() {
    // Turning about the vertical, the heading found is that of some moment before. The printed
    // way, B delayed by n − 1 of each window, knows nothing of the low-pass and twice too much of
    // the windows; seen on B alone, since gravity stays where it is.
    let rate = 0.01; // rad per sample
    let mut extraction = GravityExtraction::<f64, 5, 5>::with_cut_off(CutOff::new(0.02).unwrap());
    let field = |k: i32| {
        let attitude = r([0.0, 0.0, rate * f64::from(k)]);
        seen::<f64>(&attitude, 0.0).magnetic
    };
    let heading = |b: Vector3<f64>| (-b.y).atan2(b.x);
    let mut lag = 0.0;
    for k in 0..300 {
        let sample = Fields {
            gravity: Vector3::new(0.0, 0.0, 9.81),
            magnetic: field(k),
        };
        if let Some(found) = extraction.update(sample).unwrap() {
            lag = f64::from(k) - heading(found.magnetic) / rate;
        }
    }
    // Phase of H by hand, and 2 samples for each window.
    let tan = (TAU * 0.02 / 2.0).tan();
    let low_pass = ((rate / 2.0).tan() / tan).atan() / rate;
    assert!((lag - (low_pass + 4.0)).abs() < 1e-6, "{lag}");
    let printed = 4.0 + 4.0;
    assert!((lag - printed).abs() > 3.0, "{lag} is near {printed}");
}

/// Figure 7: x, y and z in turn along the vertical, each held still for a second, shaken with 2 g,
/// and held still again, at 100 samples a second. Gives the largest deviation of ‖g_d‖ from 1 g,
/// in g: while shaken, and from a second after it.
fn figure_7(mut extraction: GravityExtraction<f64, 5, 5>, shake_hertz: f64) -> [f64; 2] {
    let [mut shaken, mut still]: [f64; 2] = [0.0; 2];
    let push = Vector3::new(1.0, 0.8, -0.6) / 2.0_f64.sqrt();
    for down in [Vector3::x(), Vector3::y(), Vector3::z()] {
        for k in 0..500 {
            let t = f64::from(k) / 100.0;
            let strength = if (1.0..3.0).contains(&t) { 2.0 } else { 0.0 };
            let sample = Fields {
                gravity: (down + push * (strength * (TAU * shake_hertz * t).sin())) * 9.81,
                magnetic: down,
            };
            let Some(found) = extraction.update(sample).unwrap() else {
                continue;
            };
            let off = (found.gravity.norm() / 9.81 - 1.0).abs();
            if (1.0..3.0).contains(&t) {
                shaken = shaken.max(off);
            } else if t >= 4.0 {
                still = still.max(off);
            }
        }
    }
    [shaken, still]
}

#[test]
fn figure_7_the_norm_is_1_g_in_every_position_and_under_quick_shakes_at_a_fixed_cut_off() {
    for hertz in [20.0, 25.0, 30.0] {
        let fixed = GravityExtraction::with_cut_off(CutOff::new(0.02).unwrap());
        let [shaken, still] = figure_7(fixed, hertz);
        assert!(shaken < 0.1, "{hertz} Hz: {shaken} g");
        assert!(still < 1e-3, "{hertz} Hz: {still} g");
    }
}

#[test]
fn figure_7_under_shakes_the_adaptive_cut_off_opens_and_lets_them_through() {
    // The rule of 3.2.1 takes every change of the norm for one of gravity. At rest it closes
    // again, and the norm is 1 g.
    for hertz in [5.0, 10.0, 20.0] {
        let fixed = GravityExtraction::with_cut_off(CutOff::new(0.02).unwrap());
        let [by_fixed, _] = figure_7(fixed, hertz);
        let [by_adaptive, still] = figure_7(GravityExtraction::new(), hertz);
        eprintln!("{hertz} Hz: {by_adaptive:.2} g adaptive, {by_fixed:.2} g fixed");
        assert!(by_adaptive > 2.0 * by_fixed, "{by_adaptive}, {by_fixed}");
        assert!(still < 1e-3, "{hertz} Hz: {still} g");
    }
}

#[test]
fn a_reading_that_no_sensor_gives_is_left_out() {
    let good = Fields {
        gravity: Vector3::new(0.0, 0.0, 9.81_f32),
        magnetic: Vector3::new(20.0, 0.0, 40.0),
    };
    let mut extraction = GravityExtraction::<f32, 3, 3>::new();
    let mut undisturbed = GravityExtraction::<f32, 3, 3>::new();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1e9] {
        for axis in 0..3 {
            let (mut a, mut b) = (good, good);
            a.gravity[axis] = bad;
            b.magnetic[axis] = bad;
            for broken in [a, b] {
                assert_eq!(extraction.update(broken), Err(NoAttitude::NotFinite));
                assert_eq!(extraction.update(good), undisturbed.update(good));
            }
        }
    }
}
