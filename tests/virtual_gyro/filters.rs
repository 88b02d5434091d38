//! Sections 3.2.1 to 3.2.3: each filter by itself.

use crate::reference::*;
use nalgebra::Vector3;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use vrduino::virtual_gyro::average::SlidingAverage;
use vrduino::virtual_gyro::butterworth::{Coefficients, CutOff, LowPass};
use vrduino::virtual_gyro::cut_off::AdaptiveCutOff;
use vrduino::virtual_gyro::median::MedianByNorm;
use vrduino::virtual_gyro::{Fields, NoAttitude};

/// As printed, for F_c = 0.02 F_e.
const PRINTED: Coefficients<f64> = Coefficients {
    b0: 0.0305,
    b1: 0.0305,
    a1: -0.9391,
};

fn coefficients(fraction: f64) -> Coefficients<f64> {
    Coefficients::new(CutOff::new(fraction).unwrap())
}

/// |H(z)| on the unit circle, at f/F_e.
fn gain(c: &Coefficients<f64>, frequency: f64) -> f64 {
    let (sin, cos) = (TAU * frequency).sin_cos();
    let size = |real: f64, imaginary: f64| real.hypot(imaginary);
    size(c.b0 + c.b1 * cos, -c.b1 * sin) / size(1.0 + c.a1 * cos, -c.a1 * sin)
}

/// Where the gain falls to 1/√2 of that at zero frequency, by bisection.
fn half_power(c: &Coefficients<f64>) -> f64 {
    let (mut low, mut high) = (0.0, 0.5);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if gain(c, middle) > FRAC_1_SQRT_2 * gain(c, 0.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

fn along_x(x: f64) -> Fields<f64> {
    Fields {
        gravity: Vector3::new(x, 0.0, 0.0),
        magnetic: Vector3::new(0.0, x, 0.0),
    }
}

#[test]
fn the_coefficients_are_those_of_the_stated_cut_off() {
    let c = coefficients(0.02);
    assert!((c.b0 - 0.0592).abs() < 5e-5 && c.b0 == c.b1 && (c.a1 + 0.8816).abs() < 5e-5);
    for k in 1..500 {
        let fraction = f64::from(k) / 1000.0;
        let c = coefficients(fraction);
        assert!((half_power(&c) - fraction).abs() < 1e-12);
        assert!((gain(&c, 0.0) - 1.0).abs() < 1e-12);
        assert!(gain(&c, 0.5) < 1e-12);
    }
}

#[test]
fn the_printed_coefficients_are_those_of_half_the_cut_off() {
    let half = coefficients(0.01);
    for (printed, right) in [
        (PRINTED.b0, half.b0),
        (PRINTED.b1, half.b1),
        (PRINTED.a1, half.a1),
    ] {
        assert!((printed - right).abs() < 5e-5);
    }
    assert!((half_power(&PRINTED) - 0.01).abs() < 2e-5);
    assert!((gain(&PRINTED, 0.0) - 1.0016).abs() < 5e-5);
    assert!((gain(&PRINTED, 0.02) - 0.447).abs() < 1e-3, "not 0.707");
}

#[test]
fn the_filter_passes_a_wave_of_the_cut_off_frequency_at_one_over_root_two() {
    for fraction in [0.02, 0.05, 0.25] {
        let mut filter = LowPass::new(CutOff::new(fraction).unwrap());
        let mut squares = 0.0;
        for k in 0..4000 {
            let y = filter
                .update(along_x((TAU * fraction * f64::from(k)).sin()))
                .unwrap();
            if k >= 3000 {
                squares += y.gravity.x * y.gravity.x;
            }
        }
        // Whole periods: the mean square of a wave is half its amplitude's.
        let amplitude = (squares / 1000.0 * 2.0).sqrt();
        assert!((amplitude - FRAC_1_SQRT_2).abs() < 1e-9, "{amplitude}");
    }
}

#[test]
fn the_step_response_is_the_closed_form() {
    for fraction in [0.02, 0.1, 0.25, 0.4] {
        let mut filter = LowPass::new(CutOff::new(fraction).unwrap());
        filter.update(along_x(0.0)).unwrap();
        let tan = (TAU * fraction / 2.0).tan();
        let (b, pole) = (tan / (1.0 + tan), (1.0 - tan) / (1.0 + tan));
        for n in 0..200 {
            let y = filter.update(along_x(1.0)).unwrap();
            let expected = 1.0 - (1.0 - b) * pole.powi(n);
            assert!((y.gravity.x - expected).abs() < 1e-12);
            assert!((y.magnetic.y - expected).abs() < 1e-12);
        }
    }
}

#[test]
fn a_change_of_coefficients_leaves_a_settled_output_where_it_is() {
    let mut filter = LowPass::new(CutOff::new(0.02).unwrap());
    for k in 0..300 {
        filter.set_cut_off(CutOff::new(0.02 + 0.38 * f64::from(k % 8) / 7.0).unwrap());
        let y = filter.update(along_x(9.81)).unwrap();
        assert!((y.gravity.x - 9.81).abs() < 1e-12);
    }
}

#[test]
fn there_is_no_cut_off_outside_of_0_to_half_the_sampling_frequency() {
    for bad in [0.0, -0.1, 0.5, 2.0, f64::NAN, f64::INFINITY] {
        assert_eq!(CutOff::new(bad), None);
    }
}

#[test]
fn the_cut_off_opens_to_its_upper_limit_and_closes_to_its_lower() {
    let mut cut_off = AdaptiveCutOff::<f64>::new();
    let mut seen = vec![cut_off.cut_off().fraction()];
    // Changes by more than 1 % of the norm, then by less.
    for norm in (0..10).map(|k| 9.81 + 0.11 * f64::from(k)) {
        seen.push(cut_off.update(norm).fraction());
    }
    for k in 0..9 {
        seen.push(cut_off.update(10.8 + 0.1 * f64::from(k % 2)).fraction());
    }
    let expected = [
        0.02, 0.02, 0.07, 0.12, 0.17, 0.22, 0.27, 0.32, 0.37, 0.40, 0.40, // up
        0.35, 0.30, 0.25, 0.20, 0.15, 0.10, 0.05, 0.02, 0.02, // down
    ];
    for (seen, expected) in seen.iter().zip(expected) {
        assert!((seen - expected).abs() < 1e-12, "{seen} for {expected}");
    }
    // As printed: steps that pass by both limits; at 0 the filter would never move again.
    let printed = |start: f64, step: f64, n: i32| start + step * f64::from(n);
    assert!((printed(0.02, 0.05, 8) - 0.42).abs() < 1e-12);
    assert!(printed(0.40, -0.05, 8).abs() < 1e-12);
}

#[test]
fn a_norm_that_is_no_number_does_not_move_the_cut_off() {
    let mut cut_off = AdaptiveCutOff::<f32>::new();
    cut_off.update(9.81);
    for bad in [f32::NAN, f32::INFINITY] {
        assert_eq!(cut_off.update(bad), CutOff::new(0.02).unwrap());
    }
    assert_eq!(cut_off.update(9.81), CutOff::new(0.02).unwrap());
}

#[test]
fn the_median_is_the_sample_with_as_many_shorter_as_longer() {
    let mut random = Random(1);
    let mut filter = MedianByNorm::<f64, 7>::new();
    let mut all = Vec::new();
    for k in 0..20_000 {
        let sample = Fields {
            gravity: vector(random.vector(10.0)),
            magnetic: Vector3::new(f64::from(k), 0.0, 0.0),
        };
        all.push(sample);
        let found = filter.update(sample).unwrap();
        assert_eq!(found.is_some(), k >= 6);
        let Some(found) = found else { continue };
        let window = &all[all.len() - 7..];
        let shorter = |s: &&Fields<f64>| s.gravity.norm() < found.gravity.norm();
        assert_eq!(window.iter().filter(shorter).count(), 3);
        // The magnetic field is the one of the same sample.
        assert_eq!(all[found.magnetic.x as usize], found);
    }
}

#[test]
fn outliers_do_not_pass_the_median() {
    let mut filter = MedianByNorm::<f32, 5>::new();
    for k in 0..1000 {
        let spike = if k % 5 < 2 { 40.0 } else { 1.0 };
        let sample = Fields {
            gravity: Vector3::new(0.0, 0.0, 9.81) * spike,
            magnetic: Vector3::x(),
        };
        if let Some(found) = filter.update(sample).unwrap() {
            assert_eq!(found.gravity.z, 9.81);
        }
    }
}

#[test]
fn the_average_is_the_mean_of_the_window() {
    let mut random = Random(2);
    let mut filter = SlidingAverage::<f64, 4>::new();
    let mut all: Vec<Vector> = Vec::new();
    for k in 0..10_000 {
        let v = random.vector(10.0);
        all.push(v);
        let found = filter.update(Fields {
            gravity: vector(v),
            magnetic: vector(v.map(|x| 2.0 * x)),
        });
        let found = found.unwrap();
        assert_eq!(found.is_some(), k >= 3);
        let Some(found) = found else { continue };
        let mean = [0, 1, 2].map(|i| all[all.len() - 4..].iter().map(|v| v[i]).sum::<f64>() / 4.0);
        assert!(apart(array(found.gravity), mean) < 1e-12);
        assert!(apart(array(found.magnetic), mean.map(|x| 2.0 * x)) < 1e-12);
    }
}

#[test]
fn median_and_average_of_n_delay_by_half_of_n_minus_1() {
    let mut median = MedianByNorm::<f64, 5>::new();
    let mut average = SlidingAverage::<f64, 5>::new();
    let mut by_median = None;
    for k in 0..50 {
        let now = f64::from(k);
        let found = [median.update(along_x(now)), average.update(along_x(now))];
        for found in found.into_iter().filter_map(Result::unwrap) {
            assert_eq!(now - found.gravity.x, 2.0, "printed: n − 1 = 4");
            assert_eq!(now - found.magnetic.y, 2.0);
            by_median = Some(now);
        }
    }
    assert_eq!(by_median, Some(49.0));
    // A step: the median of 5 shows it with the third sample.
    let mut median = MedianByNorm::<f64, 5>::new();
    let shown = (0..20).position(|k| {
        let found = median.update(along_x(if k >= 10 { 1.0 } else { 0.0 }));
        found.unwrap().is_some_and(|found| found.gravity.x == 1.0)
    });
    assert_eq!(shown, Some(12));
}

/// What no sensor reads: it would stay in a recursive filter for ever, overflow a sum, or have no
/// place among norms.
const IMPOSSIBLE: [f32; 5] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1e9];

/// Feeds one filter broken samples between good ones, and another the good ones alone.
fn leaves_out<F: Clone, R: PartialEq + std::fmt::Debug>(
    filter: F,
    update: impl Fn(&mut F, Fields<f32>) -> Result<R, NoAttitude>,
) {
    let (mut disturbed, mut undisturbed) = (filter.clone(), filter);
    for k in 0..300_usize {
        let good = Fields {
            gravity: Vector3::new(k as f32 % 7.0, k as f32 % 5.0, 9.81),
            magnetic: Vector3::new(20.0, k as f32 % 3.0, 40.0),
        };
        let mut broken = good;
        let field = if k % 2 == 0 {
            &mut broken.gravity
        } else {
            &mut broken.magnetic
        };
        field[k % 3] = IMPOSSIBLE[k % 5];
        assert_eq!(update(&mut disturbed, broken), Err(NoAttitude::NotFinite));
        assert_eq!(update(&mut disturbed, good), update(&mut undisturbed, good));
    }
}

#[test]
fn each_filter_leaves_out_what_no_sensor_reads() {
    for fraction in [0.02, 0.4] {
        leaves_out(
            LowPass::new(CutOff::new(fraction).unwrap()),
            LowPass::update,
        );
    }
    leaves_out(MedianByNorm::<f32, 5>::new(), MedianByNorm::update);
    // From 21 on a sort notices that an order is none.
    leaves_out(MedianByNorm::<f32, 21>::new(), MedianByNorm::update);
    leaves_out(MedianByNorm::<f32, 101>::new(), MedianByNorm::update);
    leaves_out(SlidingAverage::<f32, 4>::new(), SlidingAverage::update);
}
