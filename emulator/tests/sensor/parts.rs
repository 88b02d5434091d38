//! Errors of real parts: noise against its density, everything else against the limits (PS tables 1, 2, 4; AK 5.3.3).

use std::f64::consts::FRAC_PI_2;

use vrduino_emulator::motion::Instant;
use vrduino_emulator::mpu9250::Part;
use vrduino_emulator::mpu9250::part::Axes;

use crate::driver::{Driver, G, NOTHING, at_rest, constant, statistics};

fn noisy() -> Part {
    let perfect = Part::perfect();
    Part {
        seed: 11,
        gyro: Axes {
            noise_density: 0.01,
            ..perfect.gyro
        },
        accel: Axes {
            noise_density: 300e-6,
            ..perfect.accel
        },
        ..perfect
    }
}

/// Two seconds at 1 kHz, smallest ranges: gyroscope (°/s) and accelerometer (g), axis by axis.
fn record(part: Part, filter: u8) -> [Vec<f64>; 6] {
    let mut driver = Driver::new(at_rest(), part);
    driver.write(0x1A, filter);
    driver.write(0x1D, filter);
    driver.wait(0.5);
    let mut axes: [Vec<f64>; 6] = Default::default();
    for _ in 0..8_000 {
        driver.wait_periods(1, 1_000);
        let gyro = driver.gyro().into_iter().map(|n| f64::from(n) / 131.072);
        let accel = driver.accel().into_iter().map(|n| f64::from(n) / 16_384.0);
        for (axis, value) in axes.iter_mut().zip(gyro.chain(accel)) {
            axis.push(value);
        }
    }
    axes
}

/// One pole passes noise as an ideal filter of π/2 times its bandwidth would.
#[test]
fn noise_has_the_density_of_the_data_sheet_in_the_bandwidth_of_the_filter() {
    for (filter, gyro_hz, accel_hz) in [(1, 184.0, 218.1), (2, 92.0, 99.0), (4, 20.0, 21.2)] {
        let axes = record(noisy(), filter);
        for (index, axis) in axes.iter().enumerate() {
            let (density, hz): (f64, f64) = if index < 3 {
                (0.01, gyro_hz)
            } else {
                (300e-6, accel_hz)
            };
            let expected = density * (hz * FRAC_PI_2).sqrt();
            let (mean, rms) = statistics(axis);
            assert!(
                (rms / expected - 1.0).abs() < 0.06,
                "axis {index}, filter {filter}: {rms} for {expected}"
            );
            assert!(mean.abs() < expected / 5.0, "axis {index}: {mean}");
        }
    }
    // PS table 1: 0.1 °/s rms at 92 Hz.
    let (_, rms) = statistics(&record(noisy(), 2)[0]);
    assert!((0.09..0.13).contains(&rms), "{rms} °/s");
}

#[test]
fn the_noise_of_the_axes_is_not_related() {
    let axes = record(noisy(), 1);
    for a in 0..6 {
        for b in 0..a {
            let (_, sa) = statistics(&axes[a]);
            let (_, sb) = statistics(&axes[b]);
            let covariance: f64 = axes[a].iter().zip(&axes[b]).map(|(x, y)| x * y).sum();
            let correlation = covariance / axes[a].len() as f64 / sa / sb;
            assert!(correlation.abs() < 0.08, "{a} and {b}: {correlation}");
        }
    }
}

#[test]
fn a_perfect_part_has_no_noise() {
    for axis in record(Part::perfect(), 1) {
        assert!(axis.iter().all(|value| *value == 0.0));
    }
}

/// Mean over a second at the smallest ranges that hold ±100 °/s and ±1 g.
fn mean(part: Part, instant: Instant) -> [f64; 6] {
    let mut driver = Driver::new(constant(instant), part);
    driver.write(0x1A, 0x05);
    driver.write(0x1D, 0x05);
    driver.wait(0.5);
    let mut sums = [0.0; 6];
    for _ in 0..500 {
        driver.wait_periods(1, 500);
        let gyro = driver.gyro().into_iter().map(|n| f64::from(n) / 131.072);
        let accel = driver.accel().into_iter().map(|n| f64::from(n) / 16_384.0);
        for (sum, value) in sums.iter_mut().zip(gyro.chain(accel)) {
            *sum += value / 500.0;
        }
    }
    sums
}

const BIAS_LIMITS: [f64; 6] = [5.0, 5.0, 5.0, 0.060, 0.060, 0.080];

#[test]
fn biases_lie_within_the_limits_and_those_of_a_worst_part_at_them() {
    for seed in 0..5 {
        let typical = mean(Part::typical(seed), NOTHING);
        let worst = mean(Part::worst(seed), NOTHING);
        for axis in 0..6 {
            let limit = BIAS_LIMITS[axis];
            assert!(typical[axis].abs() < limit * 1.02, "{}", typical[axis]);
            assert!(
                (worst[axis].abs() / limit - 1.0).abs() < 0.02,
                "{}",
                worst[axis]
            );
        }
        assert!(typical != worst);
    }
}

/// PS table 1: ±30 °/s from −40 to +85 °C; table 2: ±1.5 mg/°C.
#[test]
fn biases_drift_with_temperature() {
    let cold = mean(Part::worst(2).temperature(15.0), NOTHING);
    let warm = mean(Part::worst(2).temperature(35.0), NOTHING);
    for axis in 0..6 {
        let limit = if axis < 3 { 30.0 / 65.0 } else { 0.0015 };
        let drift = (warm[axis] - cold[axis]).abs() / 20.0;
        assert!(
            (drift / limit - 1.0).abs() < 0.05,
            "axis {axis}: {drift} a kelvin"
        );
    }
}

#[test]
fn scales_and_cross_axis_errors_lie_at_the_limits_of_a_worst_part() {
    let part = Part::worst(3);
    let rest = mean(part, NOTHING);
    for turned in 0..3 {
        let mut instant = NOTHING;
        instant.rate[turned] = 100f64.to_radians();
        instant.force[turned] = G;
        let moved = mean(part, instant);
        for axis in 0..6 {
            let share = (moved[axis] - rest[axis]) / if axis < 3 { 100.0 } else { 1.0 };
            let (nominal, limit) = if axis % 3 == turned {
                (1.0, 0.03)
            } else {
                (0.0, 0.02)
            };
            assert!(
                ((share - nominal).abs() - limit).abs() < 0.001,
                "axis {axis} of a turn about {turned}: {share}"
            );
        }
    }
}

#[test]
fn clocks_and_magnetometers_lie_within_their_limits() {
    for seed in 0..50 {
        for (part, worst) in [(Part::typical(seed), false), (Part::worst(seed), true)] {
            assert!(part.clock_error.abs() <= 0.01);
            assert!(part.internal_clock_error.abs() <= 0.02);
            for offset in part.magnetic.offset {
                assert!(offset.abs() <= 300.0);
                assert!(!worst || offset.abs() == 300.0);
            }
            for scale in part.magnetic.scale {
                assert!(scale.abs() <= 0.05);
            }
        }
    }
    // Two thirds of a normal distribution lie within one σ, a third of the limit.
    let inside = (0..300)
        .filter(|&seed| Part::typical(seed).clock_error.abs() < 0.01 / 3.0)
        .count();
    assert!((180..=230).contains(&inside), "{inside} of 300");
}
