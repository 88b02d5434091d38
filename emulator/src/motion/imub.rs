//! Binary recordings, `.imub`: nine axes as counts and an optical reference.
//!
//! Little-endian throughout. A header of 64 bytes:
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0 | 4 bytes | magic `IMUB` |
//! | 4 | u16 | version, 1 |
//! | 6 | u16 | header size, 64 |
//! | 8 | u32 | N, number of records |
//! | 12 | u32, u32 | sampling rate (Hz), numerator and denominator |
//! | 20 | f32 | gyroscope scale (rad/s per count) |
//! | 24 | f32 | accelerometer scale (m/s² per count) |
//! | 28 | f32 | magnetometer scale (µT per count) |
//! | 32 | 32 bytes | name, padded with zeros |
//!
//! and then N records of 28 bytes: i16 gyroscope x, y, z, accelerometer x, y, z, magnetometer x, y,
//! z, reference w, x, y, z (body → world, east-north-up, 1/32767), u16 flags (bit 0: scored, bit 1:
//! reference valid).
//!
//! The body axes are fed to the simulated sensor axis for axis, unchanged: if the recorded sensor
//! lay with its z axis up, so does the simulated one. Only the reference changes its world frame,
//! in [`y_up_from_enu`].

use super::recording::Recording;
use super::rotation::{multiply, normalized};
use super::{Instant, MotionError};
use std::f64::consts::FRAC_1_SQRT_2;

/// The first four bytes of a recording.
pub const MAGIC: &[u8; 4] = b"IMUB";

const VERSION: u16 = 1;
const HEADER: usize = 64;
const RECORD: usize = 28;
const SCORED: u16 = 1 << 0;
const REFERENCE_VALID: u16 = 1 << 1;

/// Sampling rates that can be meant (Hz): from a very slow logger to the fastest the MPU-9250
/// samples.
const RATES: std::ops::RangeInclusive<f64> = 1.0..=32_000.0;

/// The reference as a rotation body → world with y up, from body → east-north-up.
///
/// The new world is the old one seen with other axes: x is still east, y is up (the old z) and z is
/// south (the old −y). Writing a vector in it is a turn by −90° about x.
pub fn y_up_from_enu(body_to_enu: [f64; 4]) -> [f64; 4] {
    multiply([FRAC_1_SQRT_2, -FRAC_1_SQRT_2, 0.0, 0.0], body_to_enu)
}

/// What a recording holds, before anything is made of it.
#[derive(Debug, Clone)]
pub struct File {
    /// Samples per second.
    pub rate: f64,
    /// rad/s, m/s² and µT per count.
    pub scales: [f64; 3],
    /// One a sample.
    pub records: Vec<Record>,
}

/// One sample of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    /// Gyroscope, accelerometer and magnetometer, body frame.
    pub counts: [[i16; 3]; 3],
    /// The reference, body → world with y up, where it is valid.
    pub truth: Option<[f64; 4]>,
    /// Whether a benchmark counts this sample: the sensor moves.
    pub scored: bool,
}

/// Reads a recording as a motion.
///
/// # Errors
///
/// Those of [`read`].
pub fn parse(bytes: &[u8]) -> Result<Recording, MotionError> {
    let file = read(bytes)?;
    let samples = file
        .records
        .iter()
        .enumerate()
        .map(|(number, record)| {
            let [rate, force, field] =
                [0, 1, 2].map(|i| record.counts[i].map(|count| f64::from(count) * file.scales[i]));
            let instant = Instant {
                rate,
                force,
                field: Some(field),
                truth: record.truth,
            };
            (number as f64 / file.rate, instant)
        })
        .collect();
    Recording::new("recording", samples).ok_or(MotionError::Empty)
}

/// Reads a recording as it is.
///
/// # Errors
///
/// [`MotionError`] if the bytes break a rule of the format: magic, version, header size, a length
/// that is not 64 + 28 N, a scale or rate that cannot be meant, or a reference that is marked valid
/// and is no rotation.
pub fn read(bytes: &[u8]) -> Result<File, MotionError> {
    if !bytes.starts_with(MAGIC) {
        return Err(MotionError::Header {
            field: "magic",
            value: format!("{:?}, not IMUB", bytes.iter().take(4).collect::<Vec<_>>()),
        });
    }
    let cut = MotionError::Length {
        expected: HEADER as u64,
        found: bytes.len() as u64,
    };
    let (header, records) = bytes.split_first_chunk::<HEADER>().ok_or(cut)?;

    let (version, size) = (u16_at(header, 4), u16_at(header, 6));
    if (version, usize::from(size)) != (VERSION, HEADER) {
        return Err(MotionError::Version {
            version,
            header: size,
        });
    }
    let count = u32_at(header, 8);
    let expected = HEADER as u64 + u64::from(count) * RECORD as u64;
    if expected != bytes.len() as u64 {
        return Err(MotionError::Length {
            expected,
            found: bytes.len() as u64,
        });
    }
    let rate = sampling_rate(u32_at(header, 12), u32_at(header, 16))?;
    let scales = [
        scale(header, 20, "gyroscope scale", "rad/s per count")?,
        scale(header, 24, "accelerometer scale", "m/s² per count")?,
        scale(header, 28, "magnetometer scale", "µT per count")?,
    ];
    let (records, _) = records.as_chunks::<RECORD>();
    let records = records.iter().enumerate().map(|(number, record)| {
        Ok(Record {
            counts: [0, 6, 12].map(|sensor| [0, 2, 4].map(|axis| i16_at(record, sensor + axis))),
            truth: reference(number, record)?,
            scored: u16_at(record, 26) & SCORED != 0,
        })
    });
    Ok(File {
        rate,
        scales,
        records: records.collect::<Result<_, MotionError>>()?,
    })
}

fn sampling_rate(numerator: u32, denominator: u32) -> Result<f64, MotionError> {
    let rate = f64::from(numerator) / f64::from(denominator);
    if RATES.contains(&rate) {
        Ok(rate)
    } else {
        Err(MotionError::Header {
            field: "sampling rate",
            value: format!(
                "{numerator}/{denominator} Hz, not {} to {} Hz",
                RATES.start(),
                RATES.end()
            ),
        })
    }
}

fn scale(
    header: &[u8],
    offset: usize,
    field: &'static str,
    unit: &str,
) -> Result<f64, MotionError> {
    let value = f64::from(f32::from_bits(u32_at(header, offset)));
    // A full scale beyond this is no measurement, and keeps all later arithmetic finite.
    if value.is_finite() && value > 0.0 && value < 1.0e3 {
        Ok(value)
    } else {
        Err(MotionError::Header {
            field,
            value: format!("{value} {unit}, not a positive number below 1000"),
        })
    }
}

fn reference(number: usize, record: &[u8; RECORD]) -> Result<Option<[f64; 4]>, MotionError> {
    if u16_at(record, 26) & REFERENCE_VALID == 0 {
        return Ok(None);
    }
    let body_to_enu = std::array::from_fn(|i| f64::from(i16_at(record, 18 + 2 * i)) / 32767.0);
    normalized(body_to_enu)
        .map(|q| Some(y_up_from_enu(q)))
        .ok_or(MotionError::Reference { record: number })
}

fn u16_at(bytes: &[u8], offset: usize) -> u16 {
    u16::from_le_bytes([bytes[offset], bytes[offset + 1]])
}

fn i16_at(bytes: &[u8], offset: usize) -> i16 {
    u16_at(bytes, offset).cast_signed()
}

fn u32_at(bytes: &[u8], offset: usize) -> u32 {
    u32::from(u16_at(bytes, offset)) | u32::from(u16_at(bytes, offset + 2)) << 16
}
