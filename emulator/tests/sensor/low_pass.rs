//! Bandwidth and delay of every filter setting, measured with sines and ramps (RM 4.5 and 4.8).

use std::f64::consts::TAU;

use vrduino_emulator::time;

use crate::driver::{Driver, about_x};

/// Gyroscope: FCHOICE_B, DLPF_CFG, bandwidth (Hz), delay (ms), rate (Hz).
const GYRO: [(u8, u8, f64, f64, u64); 10] = [
    (0b11, 0, 8800.0, 0.064, 32_000),
    (0b10, 0, 3600.0, 0.11, 32_000),
    (0, 0, 250.0, 0.97, 8_000),
    (0, 1, 184.0, 2.9, 1_000),
    (0, 2, 92.0, 3.9, 1_000),
    (0, 3, 41.0, 5.9, 1_000),
    (0, 4, 20.0, 9.9, 1_000),
    (0, 5, 10.0, 17.85, 1_000),
    (0, 6, 5.0, 33.48, 1_000),
    (0, 7, 3600.0, 0.17, 8_000),
];

/// Accelerometer: ACCEL_CONFIG_2, bandwidth (Hz), delay (ms), rate (Hz).
const ACCEL: [(u8, f64, f64, u64); 9] = [
    (0b1000, 1046.0, 0.503, 4_000),
    (0, 218.1, 1.88, 1_000),
    (1, 218.1, 1.88, 1_000),
    (2, 99.0, 2.88, 1_000),
    (3, 44.8, 4.88, 1_000),
    (4, 21.2, 8.87, 1_000),
    (5, 10.2, 16.83, 1_000),
    (6, 5.05, 32.48, 1_000),
    (7, 420.0, 1.38, 1_000),
];

fn gyro_driver(
    fchoice_b: u8,
    dlpf: u8,
    input: impl Fn(f64) -> f64 + Send + Sync + 'static,
) -> Driver {
    let mut driver = Driver::perfect(about_x(input));
    driver.write(0x1B, 0x18 | fchoice_b);
    driver.write(0x1A, dlpf);
    driver
}

/// The gyroscope at 8 kHz, so that nothing limits how often the accelerometer is looked at.
fn accel_driver(config: u8, input: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Driver {
    let mut driver = Driver::perfect(about_x(input));
    driver.write(0x1C, 0x18);
    driver.write(0x1D, config);
    driver
}

/// Amplitude of a sine of `frequency` in samples at `hz`, by least squares.
fn amplitude(samples: &[f64], frequency: f64, hz: f64) -> f64 {
    let (mut ss, mut sc, mut cc, mut ys, mut yc) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (index, y) in samples.iter().enumerate() {
        let (s, c) = (TAU * frequency * index as f64 / hz).sin_cos();
        (ss, sc, cc) = (ss + s * s, sc + s * c, cc + c * c);
        (ys, yc) = (ys + y * s, yc + y * c);
    }
    let determinant = ss * cc - sc * sc;
    let (a, b) = (
        (ys * cc - yc * sc) / determinant,
        (yc * ss - ys * sc) / determinant,
    );
    a.hypot(b)
}

/// Output over input of a sine, sampled at `hz`.
fn gain(mut driver: Driver, accel: bool, frequency: f64, hz: u64, size: f64) -> f64 {
    driver.wait(0.5);
    let samples: Vec<f64> = (0..(2 * hz).min(16_000))
        .map(|_| {
            driver.wait_periods(1, hz);
            let counts = if accel { driver.accel() } else { driver.gyro() };
            f64::from(counts[0])
        })
        .collect();
    amplitude(&samples, frequency, hz as f64) / size
}

#[test]
fn a_sine_at_the_bandwidth_loses_three_decibels() {
    for (fchoice_b, dlpf, bandwidth, _, hz) in GYRO {
        let driver = gyro_driver(fchoice_b, dlpf, move |t| {
            1000.0 * (TAU * bandwidth * t).sin()
        });
        let gain = 20.0 * gain(driver, false, bandwidth, hz, 16_384.0).log10();
        assert!((gain + 3.01).abs() < 0.1, "gyro {dlpf}: {gain} dB");
    }
    for (config, bandwidth, _, hz) in ACCEL {
        let driver = accel_driver(config, move |t| 8.0 * (TAU * bandwidth * t).sin());
        let gain = 20.0 * gain(driver, true, bandwidth, hz, 16_384.0).log10();
        assert!((gain + 3.01).abs() < 0.1, "accel {config}: {gain} dB");
    }
}

#[test]
fn what_is_slow_passes_and_what_is_fast_does_not() {
    for (_, dlpf, bandwidth, _, hz) in GYRO.into_iter().filter(|row| row.4 == 1_000) {
        let at = |frequency: f64| {
            let driver = gyro_driver(0, dlpf, move |t| 1000.0 * (TAU * frequency * t).sin());
            gain(driver, false, frequency, hz, 16_384.0)
        };
        assert!(at(bandwidth / 10.0) > 0.99, "gyro {dlpf}");
        if bandwidth < 50.0 {
            // One pole: a tenth at ten times the bandwidth.
            let fast = at(bandwidth * 10.0);
            assert!((0.08..0.12).contains(&fast), "gyro {dlpf}: {fast}");
        }
    }
}

/// How far a ramp of `slope` counts a second lags behind (ms), averaged over samples looked at as soon as they are
/// there.
fn lag(mut driver: Driver, accel: bool, slope: f64, begins_at: f64) -> f64 {
    const LOOK: f64 = 10e-6;
    driver.wait(0.6);
    let mut lags = Vec::new();
    while lags.len() < 200 {
        driver.read(0x3A);
        let before = if accel { driver.accel() } else { driver.gyro() };
        let after = loop {
            driver.wait(LOOK);
            let counts = if accel { driver.accel() } else { driver.gyro() };
            if counts != before {
                break counts;
            }
        };
        let t = time::seconds(driver.now) - LOOK / 2.0;
        lags.push(t - begins_at - f64::from(after[0]) / slope);
        driver.wait(0.0007);
    }
    1000.0 * lags.iter().sum::<f64>() / lags.len() as f64
}

#[test]
fn a_ramp_comes_out_with_the_delay_of_the_table() {
    for (fchoice_b, dlpf, _, delay, _) in GYRO {
        let driver = gyro_driver(fchoice_b, dlpf, |t| 3000.0 * (t - 1.0));
        let lag = lag(driver, false, 3000.0 * 16.384, 1.0);
        assert!(
            (lag - delay).abs() < 0.03,
            "gyro {dlpf}: {lag} ms for {delay}"
        );
    }
    for (config, _, delay, _) in ACCEL {
        let driver = accel_driver(config, |t| 20.0 * (t - 1.0));
        let lag = lag(driver, true, 20.0 * 2048.0, 1.0);
        assert!(
            (lag - delay).abs() < 0.03,
            "accel {config}: {lag} ms for {delay}"
        );
    }
}

#[test]
fn a_reset_signal_path_starts_from_zero() {
    let mut driver = gyro_driver(0, 6, |_| 1000.0);
    driver.wait(0.5);
    assert_eq!(driver.gyro()[0], 16_384);
    // GYRO_RST: the filter starts from zero, the register keeps what it has (RM 4.31).
    driver.write(0x68, 0x04);
    assert_eq!(driver.read(0x68), 0, "it clears itself");
    assert_eq!(driver.gyro()[0], 16_384);
    driver.wait(0.01);
    let rising = driver.gyro()[0];
    assert!((1_000..8_000).contains(&rising), "{rising}");
    driver.wait(0.5);
    assert_eq!(driver.gyro()[0], 16_384);
    // SIG_COND_RST clears the registers as well (RM 4.33).
    driver.write(0x6A, 0x01);
    assert_eq!(driver.gyro()[0], 0);
    assert_eq!(driver.read(0x6A), 0, "it clears itself");
}
