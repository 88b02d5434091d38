//! Counts, units, and what a sensor makes of the truth (course notes, eq. 1 to 5; 001). The
//! sensitivities of the data sheet are in `datasheet.rs`.

mod random;

use nalgebra::{Matrix3, RealField, UnitQuaternion, Vector3, convert};
use random::Random;
use vrduino::sensor::magnetometer::{
    self, FieldError, RawField, Resolution, SensitivityAdjustment,
};
use vrduino::sensor::measurement::{Calibration, MeasurementModel, specific_force};
use vrduino::sensor::simulation::{Gaussian, SimulatedImu, SimulatedTriad};
use vrduino::sensor::{AccelRange, GyroRange, Ranges, RawSample, Sample};
use vrduino::units::{AngularRate, MagneticField, SpecificForce};

/// Every range of the gyro, and beside it every range of the accelerometer.
fn all_ranges() -> impl Iterator<Item = Ranges> {
    let pairs = GyroRange::ALL.into_iter().zip(AccelRange::ALL);
    pairs.map(|(gyro, accel)| Ranges { gyro, accel })
}

fn raw(counts: i16) -> RawSample {
    RawSample {
        gyro: [counts; 3],
        accel: [counts; 3],
        fresh: true,
        ..RawSample::default()
    }
}

/// Eq. 5 as printed.
fn printed_eq_5(counts: i16, max_range: f64) -> f64 {
    f64::from(counts) / (2.0_f64.powi(15) - 1.0) * max_range
}

#[test]
fn every_count_of_every_range_has_the_value_of_eq_5_with_the_divisor_of_the_data_sheet() {
    for ranges in all_ranges() {
        for counts in i16::MIN..=i16::MAX {
            let sample = ranges.sample::<f64>(&raw(counts));
            let share = f64::from(counts) / 32768.0;
            let dps = share * ranges.gyro.max_dps();
            let g = share * ranges.accel.max_g();
            assert!((sample.rate.dps().x - dps).abs() < 1e-10);
            assert!((sample.rate.rad_per_s().y - dps.to_radians()).abs() < 1e-12);
            assert!((sample.force.g().z - g).abs() < 1e-12);
            assert!((sample.force.m_per_s2().x - g * 9.81).abs() < 1e-11);
        }
    }
}

#[test]
fn each_axis_of_the_die_is_that_axis_of_the_body() {
    // Figure 2, left. At ±250 °/s and ±2 g; all six counts differ.
    let ranges = Ranges {
        gyro: GyroRange::Dps250,
        accel: AccelRange::G2,
    };
    let raw = RawSample {
        gyro: [16384, -8192, 4096],
        accel: [-2048, 1024, 512],
        ..RawSample::default()
    };
    let sample = ranges.sample::<f64>(&raw);
    let dps = Vector3::new(125.0, -62.5, 31.25);
    let g = Vector3::new(-0.125, 0.0625, 0.03125);
    assert!((sample.rate.dps() - dps).norm() < 1e-12);
    assert!((sample.force.g() - g).norm() < 1e-15);
    let again = ranges.counts(&sample);
    assert_eq!((again.gyro, again.accel), (raw.gyro, raw.accel));
}

#[test]
fn eq_5_as_printed_leaves_the_range_and_misses_the_sensitivity_of_the_data_sheet() {
    // One count below the end: −250.0076 °/s of a ±250 °/s range.
    assert!((printed_eq_5(i16::MIN, 250.0) + 250.007_63).abs() < 1e-5);
    assert!((printed_eq_5(i16::MIN, 2000.0) + 2_000.061_04).abs() < 1e-5);
    // Data sheet, table 2: 16384 counts are 1 g at ±2 g, exactly.
    assert!((printed_eq_5(16384, 2.0) - 1.000_030_5).abs() < 1e-7);
    let g2 = Ranges {
        gyro: GyroRange::Dps250,
        accel: AccelRange::G2,
    };
    let end = g2.sample::<f64>(&raw(i16::MIN)).rate.dps().x;
    assert!((end + 250.0).abs() < 1e-12);
    assert!((g2.sample::<f64>(&raw(16384)).force.g().x - 1.0).abs() < 1e-15);
}

#[test]
fn counts_become_values_and_the_same_counts_again() {
    for ranges in all_ranges() {
        for counts in i16::MIN..=i16::MAX {
            let raw = raw(counts);
            assert_eq!(ranges.counts(&ranges.sample::<f64>(&raw)), raw);
            assert_eq!(ranges.counts(&ranges.sample::<f32>(&raw)), raw);
        }
    }
}

#[test]
fn a_value_beyond_the_range_is_clipped_and_seen_to_be() {
    for ranges in all_ranges() {
        for (factor, clipped) in [(0.999, false), (1.001, true), (1e30, true)] {
            for sign in [1.0, -1.0] {
                for axis in 0..3 {
                    let mut dps = Vector3::zeros();
                    dps[axis] = sign * factor * ranges.gyro.max_dps();
                    let sample = Sample {
                        rate: AngularRate::from_dps(dps),
                        force: SpecificForce::from_g(Vector3::zeros()),
                    };
                    assert_eq!(ranges.counts(&sample).clipped(), clipped, "{factor}");
                    let mut g = Vector3::zeros();
                    g[axis] = sign * factor * ranges.accel.max_g();
                    let sample = Sample {
                        rate: AngularRate::zero(),
                        force: SpecificForce::from_g(g),
                    };
                    let raw = ranges.counts(&sample);
                    assert_eq!(raw.clipped(), clipped, "{factor}");
                    if clipped {
                        let end = if sign > 0.0 { i16::MAX } else { i16::MIN };
                        assert_eq!(raw.accel[axis], end);
                    }
                }
            }
        }
    }
}

#[test]
fn what_is_not_a_number_has_counts_all_the_same() {
    let ranges = Ranges {
        gyro: GyroRange::Dps2000,
        accel: AccelRange::G16,
    };
    let sample = Sample {
        rate: AngularRate::from_dps(Vector3::new(f64::NAN, f64::INFINITY, f64::NEG_INFINITY)),
        force: SpecificForce::from_g(Vector3::new(f64::MAX, f64::MIN, f64::NAN)),
    };
    let raw = ranges.counts(&sample);
    assert_eq!(raw.gyro, [0, i16::MAX, i16::MIN]);
    assert_eq!(raw.accel, [i16::MAX, i16::MIN, 0]);
}

#[test]
fn gauss_and_microtesla_are_a_hundred_apart() {
    let earth = MagneticField::from_gauss(Vector3::new(0.48, -0.25, 0.0));
    assert!((earth.microtesla() - Vector3::new(48.0, -25.0, 0.0)).norm() < 1e-13);
    let back = MagneticField::from_microtesla(earth.microtesla()).gauss();
    assert!((back - Vector3::new(0.48, -0.25, 0.0)).norm() < 1e-15);
}

fn burst(counts: [i16; 3], st2: u8) -> [u8; magnetometer::BURST_LEN] {
    let [x, y, z] = counts.map(i16::to_le_bytes);
    [x[0], x[1], y[0], y[1], z[0], z[1], st2]
}

#[test]
fn the_magnetometer_has_its_own_scale_and_eq_5_is_not_it() {
    for (st2, resolution, microtesla, largest) in [
        (0x00, Resolution::Bits14, 0.6, 8190),
        (0x10, Resolution::Bits16, 0.15, 32760),
    ] {
        let raw = RawField::from_burst(&burst([1, -largest, largest], st2));
        assert_eq!((raw.resolution, raw.overflow), (resolution, false));
        assert_eq!(raw.counts, [1, -largest, largest]);
        let field = raw.field::<f64>(SensitivityAdjustment::NONE);
        let field = field.expect("in range").microtesla();
        let end = microtesla * f64::from(largest);
        assert!((field - Vector3::new(-end, microtesla, -end)).norm() < 1e-9);
        // The data sheet: ±4912 µT at the ends.
        assert!((end / 4912.0 - 1.0).abs() < 0.0005);
    }
    // As printed, with the notes' ±4800 µT: 0.1465 µT a count, 2.34 % low.
    let printed = printed_eq_5(1, 4800.0);
    assert!((printed - 0.146_489).abs() < 1e-6);
    assert!((1.0 - printed / 0.15 - 0.0234).abs() < 1e-4);
}

#[test]
fn the_factory_adjustment_goes_with_the_axis_it_was_measured_on() {
    // H ((ASA − 128) · 0.5 / 128 + 1): 0 halves, 255 multiplies by 1.496.
    for (asa, factor) in [(0, 0.5), (128, 1.0), (192, 1.25), (255, 1.496_093_75)] {
        for axis in 0..3 {
            let mut fuses = [128; 3];
            fuses[axis] = asa;
            let adjustment = SensitivityAdjustment::from_fuse_rom(fuses);
            let raw = RawField::from_burst(&burst([100, 200, 300], 0x10));
            let field = raw.field::<f64>(adjustment).expect("in range").microtesla();
            let mut own = [15.0, 30.0, 45.0];
            own[axis] *= factor;
            let [x, y, z] = own;
            assert!((field - Vector3::new(y, x, -z)).norm() < 1e-12);
        }
    }
}

#[test]
fn the_magnetometers_axes_are_exchanged_and_not_mirrored() {
    let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(magnetometer::to_body);
    let exchange = Matrix3::<f64>::from_columns(&columns);
    assert_eq!(exchange.determinant(), 1.0);
    assert_eq!(exchange * exchange, Matrix3::identity());
    let seen = magnetometer::to_body(Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(seen, Vector3::new(2.0, 1.0, -3.0));
    // The notes' “flipping the x and y coordinates”, read as a change of sign: a mirror image.
    let printed = Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, -1.0));
    assert_eq!(printed.determinant(), -1.0);
}

#[test]
fn a_field_the_sensor_cannot_measure_is_an_error_that_says_why() {
    let field = |counts, st2| {
        let raw = RawField::from_burst(&burst(counts, st2));
        raw.field::<f32>(SensitivityAdjustment::NONE)
    };
    assert_eq!(field([1, 2, 3], 0x18), Err(FieldError::Overflow));
    assert_eq!(field([1, 2, 3], 0x08), Err(FieldError::Overflow));
    for axis in 0..3 {
        for (count, st2) in [
            (32761, 0x10),
            (-32761, 0x10),
            (i16::MIN, 0x10),
            (8191, 0),
            (-8191, 0),
        ] {
            let mut counts = [0; 3];
            counts[axis] = count;
            assert_eq!(field(counts, st2), Err(FieldError::OutOfRange), "{count}");
        }
    }
    for error in [FieldError::Overflow, FieldError::OutOfRange] {
        assert!(error.to_string().contains(": "), "{error}");
    }
}

fn model<T: RealField + Copy>(random: &mut Random) -> MeasurementModel<AngularRate<T>> {
    let faults: [[f64; 3]; 3] = [(); 3].map(|()| random.vector(0.1));
    let mixing = Matrix3::from_fn(|r, c| convert(faults[r][c] + f64::from(u8::from(r == c))));
    let bias = Vector3::from(random.vector(0.1).map(convert));
    MeasurementModel::new(mixing, AngularRate::from_rad_per_s(bias))
}

fn calibration_undoes<T: RealField + Copy>(tolerance: f64) {
    let none = AngularRate::zero();
    let mut random = Random(1);
    for _ in 0..2_000_000 {
        let model = model::<T>(&mut random);
        let calibration = model.calibration().expect("close to the identity");
        let truth = Vector3::from(random.vector(10.0).map(convert));
        let truth = AngularRate::from_rad_per_s(truth);
        let measured = model.measured(truth, none);
        let again = calibration.model().expect("as well");
        let pairs = [
            (calibration.corrected(measured), truth),
            (again.measured(truth, none), measured),
        ];
        for (a, b) in pairs {
            let difference = (a.rad_per_s() - b.rad_per_s()).norm();
            assert!(difference < convert(tolerance), "{difference}");
        }
    }
}

#[test]
fn the_calibration_of_001_undoes_eq_3() {
    calibration_undoes::<f64>(1e-9);
    calibration_undoes::<f32>(1e-5);
}

#[test]
fn the_two_documents_use_one_letter_for_two_biases() {
    // M = diag(2, 4, 5), b₀₀₀ = (1, 1, 1): A = diag(½, ¼, ⅕) and b₀₀₁ = −(½, ¼, ⅕).
    let mixing = Matrix3::from_diagonal(&Vector3::new(2.0, 4.0, 5.0));
    let bias = SpecificForce::from_m_per_s2(Vector3::new(1.0, 1.0, 1.0));
    let calibration = MeasurementModel::new(mixing, bias).calibration();
    let calibration: Calibration<_> = calibration.expect("regular");
    let expected = Vector3::new(0.5, 0.25, 0.2);
    let diagonal = Matrix3::from_diagonal(&expected);
    assert!((calibration.matrix() - diagonal).norm() < 1e-15);
    assert!((calibration.offset().m_per_s2() + expected).norm() < 1e-15);
}

#[test]
fn eq_3_is_each_row_written_out_and_eq_1_and_4_are_its_special_cases() {
    let m = [[1.0, 0.02, -0.03], [0.01, 0.98, 0.05], [-0.04, 0.06, 1.1]];
    let (b, eta, w) = ([0.1, -0.2, 0.3], [0.01, 0.02, -0.03], [1.0, 2.0, -3.0]);
    let rate = |v: [f64; 3]| AngularRate::from_rad_per_s(Vector3::from(v));
    let mixing = Matrix3::from_fn(|r, c| m[r][c]);
    let general = MeasurementModel::new(mixing, rate(b)).measured(rate(w), rate(eta));
    let aligned = MeasurementModel::aligned(rate(b)).measured(rate(w), rate(eta));
    let unbiased = MeasurementModel::without_bias(mixing).measured(rate(w), rate(eta));
    for i in 0..3 {
        let mixed = m[i][0] * w[0] + m[i][1] * w[1] + m[i][2] * w[2];
        assert!((general.rad_per_s()[i] - (mixed + b[i] + eta[i])).abs() < 1e-15);
        assert!((aligned.rad_per_s()[i] - (w[i] + b[i] + eta[i])).abs() < 1e-15);
        assert!((unbiased.rad_per_s()[i] - (mixed + eta[i])).abs() < 1e-15);
    }
    assert_eq!(
        MeasurementModel::ideal().measured(rate(w), rate([0.0; 3])),
        rate(w)
    );
}

#[test]
fn a_mixing_matrix_without_an_inverse_has_no_calibration() {
    let singular = [
        Matrix3::zeros(),
        // Rounding gives this one a determinant of 6.7e-16.
        Matrix3::new(0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9),
        Matrix3::identity() * f64::NAN,
        Matrix3::identity() * f64::INFINITY,
    ];
    for mixing in singular {
        let model = MeasurementModel::<MagneticField<f64>>::without_bias(mixing);
        assert_eq!(model.calibration(), None, "{mixing}");
    }
    let bias = MagneticField::from_microtesla(Vector3::new(f64::NAN, 0.0, 0.0));
    assert_eq!(MeasurementModel::aligned(bias).calibration(), None);
}

#[test]
fn eq_2_is_gravity_up_plus_acceleration_in_the_body() {
    // Rolled a quarter turn, the body's x points up; accelerating up as gravity pulls doubles it.
    let quarter = std::f64::consts::FRAC_PI_2;
    let rolled = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), quarter);
    let at_rest = specific_force(rolled, Vector3::zeros()).m_per_s2();
    assert!((at_rest - Vector3::new(9.81, 0.0, 0.0)).norm() < 1e-14);
    let upwards = specific_force(rolled, Vector3::new(0.0, 9.81, 0.0)).g();
    assert!((upwards - Vector3::new(2.0, 0.0, 0.0)).norm() < 1e-14);
    // Free fall: nothing is felt.
    let falling = specific_force(rolled, Vector3::new(0.0, -9.81, 0.0)).g();
    assert!(falling.norm() < 1e-14);
}

#[test]
fn the_noise_is_gaussian_and_white() {
    let mut noise = Gaussian::new(7);
    let numbers: Vec<f64> = (0..1_000_000).map(|_| noise.normal()).collect();
    let n = numbers.len() as f64;
    let moment = |power: i32| numbers.iter().map(|x| x.powi(power)).sum::<f64>() / n;
    // Standard errors: 0.001, 0.0014, 0.0039 and 0.0098; four of each.
    assert!(moment(1).abs() < 0.004);
    assert!((moment(2) - 1.0).abs() < 0.0057);
    assert!(moment(3).abs() < 0.016);
    assert!((moment(4) - 3.0).abs() < 0.04);
    let within = numbers.iter().filter(|x| x.abs() < 1.0).count() as f64 / n;
    assert!((within - 0.682_689).abs() < 0.002);
    for lag in 1..=3 {
        let pairs = numbers.iter().zip(&numbers[lag..]);
        let correlation = pairs.map(|(a, b)| a * b).sum::<f64>() / n;
        assert!(correlation.abs() < 0.004, "{lag}: {correlation}");
    }
}

fn simulated(seed: u64) -> SimulatedImu<f64> {
    let rate = |x, y, z| AngularRate::from_dps(Vector3::new(x, y, z));
    let force = |x, y, z| SpecificForce::from_m_per_s2(Vector3::new(x, y, z));
    SimulatedImu::new(
        SimulatedTriad::new(
            MeasurementModel::aligned(rate(1.0, -2.0, 3.0)),
            rate(0.1, 0.2, 0.3),
        ),
        SimulatedTriad::new(MeasurementModel::ideal(), force(0.02, 0.03, 0.04)),
        Ranges {
            gyro: GyroRange::Dps250,
            accel: AccelRange::G2,
        },
        seed,
    )
}

#[test]
fn simulated_readings_have_the_bias_and_the_deviation_asked_for() {
    let mut imu = simulated(3);
    let up = SpecificForce::from_g(Vector3::new(0.0, 1.0, 0.0));
    let n = 100_000;
    let (mut sum, mut squares) = (Vector3::zeros(), Vector3::zeros());
    for _ in 0..n {
        let dps = imu.measure(AngularRate::zero(), up).rate.dps();
        sum += dps;
        squares += dps.component_mul(&dps);
    }
    let mean = sum / f64::from(n);
    let variance = squares / f64::from(n) - mean.component_mul(&mean);
    // Four standard errors: 4σ/√n = σ/79, and 4σ²√(2/n) = σ²/56.
    for (axis, (bias, sigma)) in [(1.0, 0.1), (-2.0, 0.2), (3.0, 0.3)]
        .into_iter()
        .enumerate()
    {
        assert!((mean[axis] - bias).abs() < sigma / 79.0);
        assert!((variance[axis] / (sigma * sigma) - 1.0).abs() < 1.0 / 56.0);
    }
}

#[test]
fn the_same_seed_gives_the_same_readings() {
    let readings = |seed| {
        let mut imu = simulated(seed);
        let up = SpecificForce::from_g(Vector3::new(0.0, 1.0, 0.0));
        [(); 100].map(|()| imu.sample(AngularRate::zero(), up))
    };
    assert_eq!(readings(5), readings(5));
    assert_ne!(readings(5), readings(6));
}
