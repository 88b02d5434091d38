//! Counts mean what the data sheet says they mean.

use vrduino::sensor::{AccelRange, BURST_LEN, BURST_START, GyroRange, Ranges, RawSample, Sample};

const ONE_G: f64 = 9.81; // the course notes' value, m/s²

fn sample(gyro: GyroRange, accel: AccelRange, counts: i16) -> Sample<f64> {
    let raw = RawSample {
        gyro: [counts; 3],
        accel: [counts; 3],
        ..RawSample::default()
    };
    Ranges { gyro, accel }.sample(&raw)
}

#[test]
fn the_gyro_has_the_sensitivity_of_table_1() {
    // Data sheet, table 1: counts per °/s, as printed there (rounded).
    for (range, full_scale, sensitivity) in [
        (GyroRange::Dps250, 250.0, 131.0),
        (GyroRange::Dps500, 500.0, 65.5),
        (GyroRange::Dps1000, 1000.0, 32.8),
        (GyroRange::Dps2000, 2000.0, 16.4),
    ] {
        let dps = |counts| sample(range, AccelRange::G2, counts).rate.dps();
        for axis in 0..3 {
            assert_eq!(dps(0)[axis], 0.0);
            assert!((dps(i16::MIN)[axis] + full_scale).abs() < 1e-9, "{range:?}");
            let one_less = full_scale * 32767.0 / 32768.0;
            assert!((dps(i16::MAX)[axis] - one_less).abs() < 1e-9, "{range:?}");
            let counts_per_dps = 1.0 / dps(1)[axis];
            assert!((counts_per_dps - sensitivity).abs() < 0.1, "{range:?}");
        }
    }
}

#[test]
fn the_accelerometer_has_the_sensitivity_of_table_2() {
    // Data sheet, table 2: counts per g.
    for (range, full_scale, sensitivity) in [
        (AccelRange::G2, 2.0, 16384),
        (AccelRange::G4, 4.0, 8192),
        (AccelRange::G8, 8.0, 4096),
        (AccelRange::G16, 16.0, 2048),
    ] {
        let g = |counts| sample(GyroRange::Dps250, range, counts).force.m_per_s2() / ONE_G;
        for axis in 0..3 {
            assert_eq!(g(0)[axis], 0.0);
            assert!((g(sensitivity)[axis] - 1.0).abs() < 1e-12, "{range:?}");
            assert!((g(i16::MIN)[axis] + full_scale).abs() < 1e-12, "{range:?}");
            let one_less = full_scale * 32767.0 / 32768.0;
            assert!((g(i16::MAX)[axis] - one_less).abs() < 1e-12, "{range:?}");
        }
    }
}

#[test]
fn single_precision_agrees_with_double() {
    let ranges = Ranges {
        gyro: GyroRange::Dps2000,
        accel: AccelRange::G16,
    };
    for counts in i16::MIN..=i16::MAX {
        let raw = RawSample {
            gyro: [counts, 0, 1],
            accel: [0, counts, -1],
            ..RawSample::default()
        };
        let (single, double) = (ranges.sample::<f32>(&raw), ranges.sample::<f64>(&raw));
        let rate = single.rate.rad_per_s().cast::<f64>() - double.rate.rad_per_s();
        let force = single.force.m_per_s2().cast::<f64>() - double.force.m_per_s2();
        assert!(rate.norm() <= 1.2e-7 * double.rate.rad_per_s().amax());
        assert!(force.norm() <= 1.2e-7 * double.force.m_per_s2().amax());
    }
}

#[test]
fn degrees_and_radians_are_half_a_turn_apart_by_pi() {
    let rate = sample(GyroRange::Dps250, AccelRange::G2, i16::MIN).rate;
    assert!((rate.rad_per_s().x + 250.0 * std::f64::consts::PI / 180.0).abs() < 1e-12);
}

#[test]
fn the_burst_runs_from_int_status_to_gyro_zout_l() {
    assert_eq!(BURST_START, 0x3A);
    assert_eq!(usize::from(BURST_START) + BURST_LEN - 1, 0x48);
}

/// Register map, registers 58 to 72: which byte of the burst is which half of what.
#[test]
fn every_byte_of_the_burst_has_its_place() {
    type Field = fn(&RawSample) -> i16;
    let fields: [Field; 7] = [
        |s| s.accel[0],
        |s| s.accel[1],
        |s| s.accel[2],
        |s| s.temperature,
        |s| s.gyro[0],
        |s| s.gyro[1],
        |s| s.gyro[2],
    ];
    for place in 1..BURST_LEN {
        for value in [0x01, 0x7F, 0x80, 0xFF] {
            let mut burst = [0; BURST_LEN];
            burst[place] = value;
            let raw = RawSample::from_burst(&burst);
            let high = place % 2 == 1;
            for (index, field) in fields.iter().enumerate() {
                let expected = match (index == (place - 1) / 2, high) {
                    (true, true) => (u16::from(value) << 8) as i16,
                    (true, false) => i16::from(value),
                    (false, _) => 0,
                };
                assert_eq!(field(&raw), expected, "byte {place}, field {index}");
            }
            assert!(!raw.fresh, "byte {place}");
        }
    }
}

#[test]
fn only_bit_0_of_the_status_says_the_sample_is_new() {
    for status in 0..=u8::MAX {
        let mut burst = [0x55; BURST_LEN];
        burst[0] = status;
        assert_eq!(RawSample::from_burst(&burst).fresh, status & 1 == 1);
    }
}

#[test]
fn a_whole_burst_reads_as_written() {
    let burst = [
        0x01, 0x7F, 0xFF, 0x80, 0x00, 0x12, 0x34, 0xFC, 0x18, 0xFF, 0xFF, 0x00, 0x01, 0x56, 0x78,
    ];
    let expected = RawSample {
        accel: [32767, -32768, 0x1234],
        temperature: -1000,
        gyro: [-1, 1, 0x5678],
        fresh: true,
    };
    assert_eq!(RawSample::from_burst(&burst), expected);
}

#[test]
fn the_temperature_is_signed() {
    let celsius = |temperature| {
        let raw = RawSample {
            temperature,
            ..RawSample::default()
        };
        raw.temperature_celsius()
    };
    assert_eq!(celsius(0), 21.0);
    assert!((celsius(-1000) - 18.0048).abs() < 1e-3);
    assert!((celsius(3339) - 31.0).abs() < 1e-2);
}

#[test]
fn a_value_at_the_end_of_the_range_is_clipped() {
    assert!(!RawSample::default().clipped());
    for axis in 0..3 {
        for end in [i16::MIN, i16::MAX] {
            let mut raw = RawSample::default();
            raw.gyro[axis] = end;
            assert!(raw.clipped());
            raw.gyro[axis] = end / 2;
            assert!(!raw.clipped());
            raw.accel[axis] = end;
            assert!(raw.clipped());
        }
    }
}
