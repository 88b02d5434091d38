//! The bias is taken from a board that lies still, and from no other.

mod random;

use nalgebra::Vector3;
use random::Random;
use vrduino::calibration::{GyroBias, Rest, Stillness, Verdict, WINDOW};
use vrduino::sensor::{AccelRange, GyroRange, Ranges, RawSample, Sample};
use vrduino::units::{AngularRate, SpecificForce};

const RANGES: Ranges = Ranges {
    gyro: GyroRange::Dps2000,
    accel: AccelRange::G16,
};
const COUNTS_PER_DPS: f64 = 16.384;
const COUNTS_PER_M_PER_S2: f64 = 2048.0 / 9.81;

/// Noise of the data sheet: 0.01 °/s/√Hz × √184 Hz, 300 µg/√Hz × √218 Hz.
const GYRO_NOISE_DPS: f64 = 0.136;
const FORCE_NOISE: f64 = 0.0435;

impl Random {
    /// Standard normal, to the accuracy of twelve uniform summands.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

/// A window of a sensor that reads `motion(second)` (°/s, m/s²) plus the data sheet's noise.
fn window(seed: u64, motion: impl Fn(f64) -> ([f64; 3], [f64; 3])) -> Vec<RawSample> {
    let mut noise = Random(seed * 2 + 1);
    let count = |value: f64| value.round().clamp(-32768.0, 32767.0) as i16;
    (0..WINDOW)
        .map(|i| {
            let (rate, force) = motion(f64::from(i) / 1000.0);
            RawSample {
                gyro: rate.map(|r| count((r + GYRO_NOISE_DPS * noise.normal()) * COUNTS_PER_DPS)),
                accel: force
                    .map(|f| count((f + FORCE_NOISE * noise.normal()) * COUNTS_PER_M_PER_S2)),
                temperature: 0,
                fresh: true,
            }
        })
        .collect()
}

fn judge(samples: &[RawSample]) -> Verdict {
    let mut stillness = Stillness::new(RANGES);
    let (last, others) = samples.split_last().expect("a window is not empty");
    for raw in others {
        assert_eq!(stillness.push(raw), Verdict::Collecting);
    }
    stillness.push(last)
}

fn expect_still(samples: &[RawSample]) -> Rest {
    match judge(samples) {
        Verdict::Still(rest) => rest,
        other => panic!("not still: {other:?}"),
    }
}

const BIAS: [f64; 3] = [0.174, -0.199, 0.446];
const UP: [f64; 3] = [0.37, 9.5, 2.3];

#[test]
fn the_bias_of_a_still_board_is_recovered() {
    for seed in 0..50 {
        let rest = expect_still(&window(seed, |_| (BIAS, UP)));
        for axis in 0..3 {
            let bias = f64::from(rest.gyro_bias.dps()[axis]);
            // The mean of 1000 samples scatters by 0.136/√1000 = 0.0043; five times that.
            assert!((bias - BIAS[axis]).abs() < 0.022, "axis {axis}: {bias}");
            let force = f64::from(rest.force.m_per_s2()[axis]);
            assert!((force - UP[axis]).abs() < 0.01, "axis {axis}: {force}");
            let sigma = f64::from(rest.gyro_variance_dps2[axis]).sqrt();
            assert!((sigma - GYRO_NOISE_DPS).abs() < 0.02, "{sigma}");
            let sigma = f64::from(rest.force_variance_m2_per_s4[axis]).sqrt();
            assert!((sigma - FORCE_NOISE).abs() < 0.005, "{sigma}");
        }
    }
}

#[test]
fn mean_and_variance_are_exact_in_any_position() {
    // A large mean with a variance of 1/4 count², where single precision would see nothing.
    let samples: Vec<_> = (0..WINDOW)
        .map(|i| RawSample {
            gyro: [160 + (i % 2) as i16, -160, 0],
            accel: [-2048 + (i % 2) as i16, 0, 0],
            temperature: 0,
            fresh: true,
        })
        .collect();
    let rest = expect_still(&samples);
    let close = |value: f32, expected: f64| (f64::from(value) / expected - 1.0).abs() < 1e-6;
    assert!(close(rest.gyro_bias.dps().x, 160.5 / COUNTS_PER_DPS));
    assert!(close(
        rest.gyro_variance_dps2.x,
        0.25 / COUNTS_PER_DPS.powi(2)
    ));
    assert_eq!(rest.gyro_variance_dps2.y, 0.0);
    let variance = 0.25 / COUNTS_PER_M_PER_S2.powi(2);
    assert!(close(rest.force_variance_m2_per_s4.x, variance));
}

#[test]
fn the_temperature_of_the_rest_is_noted() {
    let mut samples = window(11, |_| (BIAS, UP));
    for (i, raw) in samples.iter_mut().enumerate() {
        // Below 21 °C counts are negative; data sheet: 333.87 of them per °C.
        raw.temperature = if i % 2 == 0 { -3338 } else { -3339 };
    }
    let celsius = expect_still(&samples).temperature_celsius;
    assert!((celsius - 11.0).abs() < 0.001, "{celsius}");
}

#[test]
fn a_worn_board_is_not_still() {
    // Someone trying to hold their head still: 1.5 °/s of sway at 0.8 Hz.
    for seed in 0..20 {
        let phase = seed as f64;
        let sway = |t: f64| 1.5 * (std::f64::consts::TAU * 0.8 * t + phase).sin();
        let samples = window(seed, |t| ([BIAS[0], BIAS[1] + sway(t), BIAS[2]], UP));
        assert_eq!(judge(&samples), Verdict::Moved, "seed {seed}");
    }
}

#[test]
fn a_slow_steady_tilt_is_not_still() {
    // 1 °/s about x from level. The gyro alone cannot tell that from a bias.
    let samples = window(3, |t| {
        let angle = t.to_radians();
        (
            [1.0, 0.0, 0.0],
            [0.0, 9.81 * angle.cos(), -9.81 * angle.sin()],
        )
    });
    assert_eq!(judge(&samples), Verdict::Moved);
}

#[test]
fn a_slow_wander_is_not_still() {
    let samples = window(4, |t| ([0.0, 0.6 * t, 0.0], UP));
    assert_eq!(judge(&samples), Verdict::Moved);
}

#[test]
fn a_vibrating_table_is_not_still() {
    let shake = |t: f64| 0.5 * (std::f64::consts::TAU * 50.0 * t).sin();
    let samples = window(5, |t| (BIAS, [UP[0], UP[1] + shake(t), UP[2]]));
    assert_eq!(judge(&samples), Verdict::Moved);
}

#[test]
fn a_single_knock_is_not_still_and_the_next_window_is() {
    let knocked = window(6, |t| {
        let hit = if (0.5..0.51).contains(&t) { 8.0 } else { 0.0 };
        (BIAS, [UP[0] + hit, UP[1], UP[2]])
    });
    let quiet = window(7, |_| (BIAS, UP));
    let mut stillness = Stillness::new(RANGES);
    let verdicts: Vec<_> = knocked
        .iter()
        .chain(&quiet)
        .map(|raw| stillness.push(raw))
        .filter(|verdict| *verdict != Verdict::Collecting)
        .collect();
    assert_eq!(verdicts[0], Verdict::Moved);
    assert!(matches!(verdicts[1], Verdict::Still(_)));
    assert_eq!(verdicts.len(), 2);
}

#[test]
fn a_turntable_is_not_a_bias() {
    let samples = window(8, |_| ([0.0, 33.3 * 6.0, 0.0], [0.0, 9.81, 0.0]));
    assert_eq!(judge(&samples), Verdict::Moved);
    let samples = window(8, |_| ([0.0, 10.5, 0.0], [0.0, 9.81, 0.0]));
    assert_eq!(judge(&samples), Verdict::Moved);
    // The worst the data sheet allows at 25 °C.
    expect_still(&window(9, |_| ([5.0, -5.0, 5.0], UP)));
}

#[test]
fn the_ends_of_the_range_do_not_overflow() {
    for value in [i16::MIN, i16::MAX] {
        let raw = RawSample {
            gyro: [value; 3],
            accel: [value; 3],
            temperature: value,
            fresh: true,
        };
        assert_eq!(judge(&[raw; WINDOW as usize]), Verdict::Moved);
    }
    let swing: Vec<_> = (0..WINDOW)
        .map(|i| {
            let value = if i % 2 == 0 { i16::MIN } else { i16::MAX };
            RawSample {
                gyro: [value; 3],
                accel: [value; 3],
                temperature: 0,
                fresh: true,
            }
        })
        .collect();
    assert_eq!(judge(&swing), Verdict::Moved);
}

#[test]
fn a_sensor_that_has_stopped_does_not_pass_for_still() {
    let mut stillness = Stillness::new(RANGES);
    let stopped = RawSample {
        accel: [0, 2048, 0],
        fresh: false,
        ..RawSample::default()
    };
    for _ in 0..10 * WINDOW {
        assert_eq!(stillness.push(&stopped), Verdict::Collecting);
    }
}

#[test]
fn correction_subtracts_the_bias_and_leaves_the_force_alone() {
    let sample = Sample {
        rate: AngularRate::from_dps(Vector3::new(1.0, 2.0, 3.0)),
        force: SpecificForce::from_m_per_s2(Vector3::new(4.0, 5.0, 6.0)),
    };
    let bias = GyroBias::new(AngularRate::from_dps(Vector3::new(0.5, 0.5, -0.5)));
    let reading = bias.correct(sample);
    let expected = Vector3::<f64>::new(0.5, 1.5, 3.5);
    assert!((reading.rate().dps() - expected).norm() < 1e-12);
    assert_eq!(reading.force(), sample.force);
    assert_eq!(GyroBias::zero().correct(sample).rate(), sample.rate);
}
