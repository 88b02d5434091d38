//! Section 3.2, figure 4 and figure 7: the three filters in a row.

use crate::reference::*;
use nalgebra::Vector3;
use std::f64::consts::TAU;
use vrduino::virtual_gyro::butterworth::CutOff;
use vrduino::virtual_gyro::median::MedianByNorm;
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

/// Figure 4 written out on plain arrays of g_d and B_d: the low-pass of 3.2.1 from the analogue
/// 1/(1 + s/ω) by s = 2 (z − 1)/(z + 1), the sample of the median norm of `median`, the mean of
/// `mean`; and F_c, where it adapts, by the norm of what comes out.
fn chain(samples: &[[f64; 6]], cut_off: Option<f64>, median: usize, mean: usize) -> Vec<[f64; 7]> {
    let mut fraction = cut_off.unwrap_or(0.02);
    let (mut smooth, mut chosen) = (vec![samples[0]], Vec::new());
    let mut found: Vec<[f64; 7]> = Vec::new();
    let size = |v: &[f64]| v[..3].iter().map(|c| c * c).sum::<f64>().sqrt();
    for (k, now) in samples.iter().enumerate() {
        let before = samples[k.saturating_sub(1)];
        let omega = 2.0 * (TAU / 2.0 * fraction).tan();
        let last = smooth[k];
        let sum = |i: usize| omega * (now[i] + before[i]) + (2.0 - omega) * last[i];
        smooth.push([0, 1, 2, 3, 4, 5].map(|i| sum(i) / (2.0 + omega)));
        if k + 1 < median {
            continue;
        }
        let mut window = smooth[smooth.len() - median..].to_vec();
        window.sort_by(|a, b| size(a).total_cmp(&size(b)));
        chosen.push(window[median / 2]);
        if chosen.len() < mean {
            continue;
        }
        let window = &chosen[chosen.len() - mean..];
        let average = |i: usize| window.iter().map(|v| v[i]).sum::<f64>() / mean as f64;
        let [a, b, c, d, e, f] = [0, 1, 2, 3, 4, 5].map(average);
        if let (None, Some(last)) = (cut_off, found.last()) {
            let now = size(&[a, b, c]);
            let varies = (now - size(last)).abs() > now / 100.0;
            fraction += if varies { 0.05 } else { -0.05 };
            fraction = fraction.clamp(0.02, 0.4);
        }
        found.push([a, b, c, d, e, f, fraction]);
    }
    found
}

#[test]
fn the_three_filters_in_a_row_are_those_of_figure_4() {
    let mut random = Random(2);
    let samples: Vec<[f64; 6]> = (0..5000)
        .map(|k| {
            let size = if k % 300 < 150 { 12.0 } else { 0.05 };
            let ([x, y, z], [a, b, c]) = (random.vector(size), random.vector(size));
            [x, y + 9.81, z, a + 20.0, b, c + 40.0]
        })
        .collect();
    for cut_off in [None, Some(0.02), Some(0.3)] {
        let mut extraction = match cut_off {
            None => GravityExtraction::<f64, 5, 4>::new(),
            Some(fraction) => GravityExtraction::with_cut_off(CutOff::new(fraction).unwrap()),
        };
        let mut expected = chain(&samples, cut_off, 5, 4).into_iter();
        for [x, y, z, a, b, c] in &samples {
            let sample = Fields {
                gravity: Vector3::new(*x, *y, *z),
                magnetic: Vector3::new(*a, *b, *c),
            };
            let Some(found) = extraction.update(sample).unwrap() else {
                continue;
            };
            let [x, y, z, a, b, c, fraction] = expected.next().unwrap();
            assert!(apart(array(found.gravity), [x, y, z]) < 1e-9);
            assert!(apart(array(found.magnetic), [a, b, c]) < 1e-9);
            let adapted = extraction.adaptive_cut_off().map(CutOff::fraction);
            assert!((adapted.unwrap_or(fraction) - fraction).abs() < 1e-12);
        }
        assert!(expected.next().is_none());
    }
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
/// and held still again, at 100 samples a second. Gives the largest deviation of ‖g_d‖ from 1 g, in
/// g, while shaken and from a second after it; and that of its direction while shaken, in degrees.
fn figure_7(mut extraction: GravityExtraction<f64, 5, 5>, shake_hertz: f64) -> [f64; 3] {
    let [mut shaken, mut still, mut aside]: [f64; 3] = [0.0; 3];
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
                let across = found.gravity.cross(&down).norm();
                aside = aside.max(across.atan2(found.gravity.dot(&down)).to_degrees());
            } else if t >= 4.0 {
                still = still.max(off);
            }
        }
    }
    [shaken, still, aside]
}

#[test]
fn figure_7_the_norm_is_1_g_in_every_position_and_under_quick_shakes_at_a_fixed_cut_off() {
    for hertz in [20.0, 25.0, 30.0] {
        let fixed = GravityExtraction::with_cut_off(CutOff::new(0.02).unwrap());
        let [shaken, still, _] = figure_7(fixed, hertz);
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
        let [by_fixed, _, _] = figure_7(fixed, hertz);
        let [by_adaptive, still, _] = figure_7(GravityExtraction::new(), hertz);
        eprintln!("{hertz} Hz: {by_adaptive:.2} g adaptive, {by_fixed:.2} g fixed");
        assert!(by_adaptive > 2.0 * by_fixed, "{by_adaptive}, {by_fixed}");
        assert!(still < 1e-3, "{hertz} Hz: {still} g");
    }
}

#[test]
fn figure_7_a_norm_near_1_g_does_not_mean_that_down_is_right() {
    // The paper's proof is the norm. A push across gravity turns it before it lengthens it.
    for hertz in [20.0, 25.0] {
        let fixed = GravityExtraction::with_cut_off(CutOff::new(0.02).unwrap());
        let [norm, _, aside] = figure_7(fixed, hertz);
        eprintln!("{hertz} Hz, fixed: {norm:.2} g, {aside:.1}°");
        assert!(norm < 0.1 && aside > 4.0, "{norm}, {aside}");
        let [_, _, aside] = figure_7(GravityExtraction::new(), hertz);
        assert!(aside > 45.0, "{aside}");
    }
}

#[test]
fn an_outlier_that_the_median_alone_eliminates_passes_the_chain_as_a_long_swell() {
    // One sample of 16 g among 1 g. In figure 4 the low-pass stands before the median and makes of
    // one outlier a decay longer than any window, which has no outlier in it. How long ‖g_d‖ is
    // off by more than 0.1 m/s², and by how much at most (m/s²):
    let swell = |mut found: Box<dyn FnMut(Fields<f64>) -> Option<Fields<f64>>>| {
        let (mut samples, mut most) = (0, 0.0_f64);
        for k in 0..500 {
            let down = Vector3::new(0.0, 0.0, 9.81);
            let found = found(Fields {
                gravity: if k == 100 { down * 16.0 } else { down },
                magnetic: Vector3::x(),
            });
            let off = found.map_or(0.0, |found| (found.gravity.norm() - 9.81).abs());
            samples += u32::from(off > 0.1);
            most = most.max(off);
        }
        (samples, most)
    };
    let mut median = MedianByNorm::<f64, 5>::new();
    let alone = swell(Box::new(move |sample| median.update(sample).unwrap()));
    assert_eq!(alone, (0, 0.0));
    let cut_off = CutOff::new(0.02).unwrap();
    let mut fixed = GravityExtraction::<f64, 5, 5>::with_cut_off(cut_off);
    let (samples, most) = swell(Box::new(move |sample| fixed.update(sample).unwrap()));
    assert_eq!(samples, 44);
    assert!((most - 11.87).abs() < 0.005, "{most}");

    let mut adaptive = GravityExtraction::<f64, 5, 5>::new();
    let (samples, most) = swell(Box::new(move |sample| adaptive.update(sample).unwrap()));
    assert_eq!(samples, 10);
    assert!((most - 8.04).abs() < 0.005, "{most}");
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
