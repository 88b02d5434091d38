//! What is kept comes back to the bit; what is damaged, of another version or never written does not.

mod random;

use nalgebra::{Matrix3, Vector3};
use random::Random;
use vrduino::calibration::ellipsoid::Magnetometer;
use vrduino::calibration::record::{Gyro, LENGTH, Record, RecordError};
use vrduino::calibration::six_positions::Accelerometer;
use vrduino::calibration::{Correction, GyroBias};
use vrduino::sensor::Sample;
use vrduino::units::{Angle, AngularRate, MagneticField, SpecificForce};

fn full() -> Record {
    Record {
        gyro: Some(Gyro {
            bias: AngularRate::from_rad_per_s(Vector3::new(0.01, -0.02, 0.03)),
            temperature_celsius: 24.5,
        }),
        accelerometer: Some(Accelerometer {
            bias: SpecificForce::from_m_per_s2(Vector3::new(0.5, -0.25, 0.125)),
            matrix: Matrix3::new(
                1.125, 0.0625, 0.03125, -0.0625, 0.875, 0.09375, -0.03125, 0.015_625, 1.25,
            ),
            residual: 0.004,
            placing: Angle::from_rad(0.015),
            temperature_celsius: 27.0,
        }),
        magnetometer: Some(Magnetometer {
            hard_iron: MagneticField::from_microtesla(Vector3::new(30.0, -84.0, 12.0)),
            soft_iron: Matrix3::new(1.5, 0.25, -0.125, 0.25, 0.5, 0.0625, -0.125, 0.0625, 1.0),
            strength_microtesla: 48.5,
            error_percent: 1.25,
            coverage: 0.875,
            largest_hole: Angle::from_rad(0.5),
            temperature_celsius: -3.0,
        }),
    }
}

/// CRC-32 as a division of polynomials, bit by bit and from the other end than the library's.
fn checksum(bytes: &[u8]) -> u32 {
    let mut register = u64::from(u32::MAX);
    for bit in bytes
        .iter()
        .flat_map(|byte| (0..8).map(move |n| byte >> n & 1))
    {
        register = register << 1 ^ u64::from(bit) << 32;
        if register >> 32 & 1 == 1 {
            register ^= 0x1_04C1_1DB7;
        }
        register &= 0xFFFF_FFFF;
    }
    !(register as u32).reverse_bits()
}

/// With a checksum that fits again.
fn sealed(mut bytes: [u8; LENGTH]) -> [u8; LENGTH] {
    let sum = checksum(&bytes[..LENGTH - 4]);
    bytes[LENGTH - 4..].copy_from_slice(&sum.to_le_bytes());
    bytes
}

#[test]
fn what_is_kept_comes_back_to_the_bit() {
    let whole = full();
    for parts in 0..8 {
        let record = Record {
            gyro: whole.gyro.filter(|_| parts & 1 != 0),
            accelerometer: whole.accelerometer.filter(|_| parts & 2 != 0),
            magnetometer: whole.magnetometer.filter(|_| parts & 4 != 0),
        };
        let bytes = record.to_bytes();
        assert_eq!(bytes[..4], [b'V', b'C', 1, parts]);
        assert_eq!(bytes, sealed(bytes));
        assert_eq!(Record::from_bytes(&bytes), Ok(record));
    }
}

#[test]
fn the_layout_is_the_documented_one() {
    let bytes = full().to_bytes();
    let number = |offset: usize| f32::from_le_bytes(bytes[offset..][..4].try_into().expect("4"));
    assert_eq!(LENGTH, 140);
    assert_eq!([4, 8, 12, 16].map(number), [0.01, -0.02, 0.03, 24.5]);
    // Bias, then the matrix's second element of its first row, and the first of its second.
    assert_eq!([20, 36, 44].map(number), [0.5, 0.0625, -0.0625]);
    assert_eq!([68, 72, 76].map(number), [0.004, 0.015, 27.0]);
    assert_eq!([84, 92, 96, 100].map(number), [-84.0, 1.5, 0.25, -0.125]);
    assert_eq!([104, 108, 112].map(number), [0.5, 0.0625, 1.0]);
    let figures = [116, 120, 124, 128, 132].map(number);
    assert_eq!(figures, [48.5, 1.25, 0.875, 0.5, -3.0]);
}

#[test]
fn one_flipped_bit_anywhere_is_refused() {
    let bytes = full().to_bytes();
    for bit in 0..8 * LENGTH {
        let mut damaged = bytes;
        damaged[bit / 8] ^= 1 << (bit % 8);
        let error = Record::from_bytes(&damaged).expect_err("damaged");
        match bit / 8 {
            0 | 1 => assert_eq!(error, RecordError::NotARecord),
            2 => assert_eq!(error, RecordError::Version(damaged[2])),
            _ => assert!(matches!(error, RecordError::Checksum { .. }), "{error}"),
        }
    }
}

#[test]
fn half_written_or_never_written_is_refused() {
    let bytes = full().to_bytes();
    for blank in [0x00, 0xFF] {
        let memory = [blank; LENGTH];
        assert_eq!(Record::from_bytes(&memory), Err(RecordError::Empty));
        // The supply went away while writing over a blank memory.
        for written in 3..LENGTH - 4 {
            let mut cut = memory;
            cut[..written].copy_from_slice(&bytes[..written]);
            let error = Record::from_bytes(&cut).expect_err("cut");
            assert!(
                matches!(error, RecordError::Checksum { .. }),
                "{written}: {error}"
            );
        }
    }
    for length in (0..LENGTH).chain([LENGTH + 1, 2048]) {
        let other = vec![0xFF; length];
        assert_eq!(Record::from_bytes(&other), Err(RecordError::Length(length)));
    }
}

#[test]
fn what_cannot_be_meant_is_refused_though_its_checksum_is_right() {
    let good = full().to_bytes();
    let mut newer = good;
    newer[2] = 2;
    assert_eq!(
        Record::from_bytes(&sealed(newer)),
        Err(RecordError::Version(2))
    );
    let mut unknown = good;
    unknown[3] = 0x17;
    let error = Record::from_bytes(&sealed(unknown));
    assert_eq!(error, Err(RecordError::UnknownPart(0x17)));
    for offset in (4..LENGTH - 4).step_by(4) {
        for bad in [f32::NAN, f32::INFINITY, -1e5] {
            let mut bytes = good;
            bytes[offset..offset + 4].copy_from_slice(&bad.to_le_bytes());
            let error = Record::from_bytes(&sealed(bytes));
            assert_eq!(error, Err(RecordError::Value { offset }), "{bad}");
        }
    }
}

#[test]
fn noise_is_never_a_record_and_never_a_panic() {
    let mut random = Random(12);
    for _ in 0..20_000 {
        let mut bytes = [(); LENGTH].map(|()| (random.unit() * 256.0) as u8);
        if random.unit() < 0.5 {
            bytes[..3].copy_from_slice(b"VC\x01");
        }
        let error = Record::from_bytes(&bytes).expect_err("noise");
        assert!(error.to_string().contains("calibrate again"));
    }
}

#[test]
fn a_correction_applies_all_three() {
    let correction = full().correction();
    let sample = Sample {
        rate: AngularRate::from_rad_per_s(Vector3::new(1.0, 2.0, 3.0)),
        force: SpecificForce::from_m_per_s2(Vector3::new(2.5, 3.75, 8.125)),
    };
    let reading = correction.correct(sample);
    // Written out by hand: rate − bias, and A (force − bias) with force − bias = (2, 4, 8).
    let rate = Vector3::new(0.99, 2.02, 2.97);
    let force = Vector3::new(
        2.25 + 0.25 + 0.25,
        -0.125 + 3.5 + 0.75,
        -0.0625 + 0.0625 + 10.0,
    );
    assert!((reading.rate().rad_per_s() - rate).amax() < 1e-6);
    assert!((reading.force().m_per_s2() - force).amax() < 1e-5);
    // For an estimator that keeps the bias itself, the rate stays.
    assert_eq!(correction.sample(sample).rate, sample.rate);
    assert_eq!(correction.sample(sample).force, reading.force());
    // Field − hard iron = (4, 8, 16).
    let field = MagneticField::from_microtesla(Vector3::new(34.0, -76.0, 28.0));
    let expected = Vector3::new(6.0 + 2.0 - 2.0, 1.0 + 4.0 + 1.0, -0.5 + 0.5 + 16.0);
    let corrected = correction.field(field).microtesla();
    assert!((corrected - expected).amax() < 1e-4, "{corrected}");
}

#[test]
fn an_empty_record_changes_nothing() {
    let correction = Record::default().correction();
    assert_eq!(correction, Correction::none());
    let sample = Sample {
        rate: AngularRate::from_rad_per_s(Vector3::new(1.0, 2.0, 3.0)),
        force: SpecificForce::from_m_per_s2(Vector3::new(4.0, 5.0, 6.0)),
    };
    assert_eq!(correction.correct(sample), GyroBias::zero().correct(sample));
    let field = MagneticField::from_microtesla(Vector3::new(1.0, -2.0, 3.0));
    assert_eq!(correction.field(field), field);
}
