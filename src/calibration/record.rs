//! Calibrations as bytes, to be kept where the board finds them again.
//!
//! Little-endian; numbers are single precision. [`LENGTH`] bytes, whatever is in it.
//!
//! | offset | bytes | what |
//! |---|---|---|
//! | 0 | 2 | `VC` |
//! | 2 | 1 | version, 1 |
//! | 3 | 1 | what there is: bit 0 gyro, bit 1 accelerometer, bit 2 magnetometer; the rest 0 |
//! | 4 | 16 | gyro: bias x, y, z (rad/s), temperature (°C) |
//! | 20 | 60 | accelerometer: bias x, y, z (m/s²), matrix row by row, residual (m/s²), placing (rad), temperature (°C) |
//! | 80 | 56 | magnetometer: hard iron x, y, z (µT), soft iron xx, xy, xz, yy, yz, zz, strength (µT), error (%), coverage (0 to 1), largest hole (rad), temperature (°C) |
//! | 136 | 4 | CRC-32 (as in Ethernet and ZIP) of all before |
//!
//! What there is not is zero. A reader refuses what it does not understand: after a power cut in the
//! middle of writing, a board without a calibration is better than one with half of it.

use super::ellipsoid::Magnetometer;
use super::six_positions::Accelerometer;
use super::{Correction, GyroBias, Rest};
use crate::units::{Angle, AngularRate, MagneticField, SpecificForce};
use core::fmt;
use core::ops::RangeInclusive;
use nalgebra::{Matrix3, Vector3};

/// Bytes of a record.
pub const LENGTH: usize = BODY + 4;

const BODY: usize = 136;
const MAGIC: [u8; 2] = *b"VC";
const VERSION: u8 = 1;

const GYRO: u8 = 1 << 0;
const ACCELEROMETER: u8 = 1 << 1;
const MAGNETOMETER: u8 = 1 << 2;

/// No value of any calibration is larger, in any unit used here.
const LARGEST: f32 = 10_000.0;

/// The gyro's bias with what was noted beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gyro {
    /// Body frame.
    pub bias: AngularRate<f32>,
    /// Temperature of the die when it was measured, °C.
    pub temperature_celsius: f32,
}

impl From<Rest> for Gyro {
    fn from(rest: Rest) -> Self {
        Self {
            bias: rest.gyro_bias,
            temperature_celsius: rest.temperature_celsius,
        }
    }
}

/// The results that are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Record {
    /// Of a still second.
    pub gyro: Option<Gyro>,
    /// Of six positions.
    pub accelerometer: Option<Accelerometer<f32>>,
    /// Of an ellipsoid fit.
    pub magnetometer: Option<Magnetometer<f32>>,
}

/// Why bytes are no record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordError {
    /// Not [`LENGTH`] bytes but so many.
    Length(usize),
    /// All bytes are 0xFF, or all are 0: nothing was ever written there.
    Empty,
    /// It does not begin with `VC`: something else was written there.
    NotARecord,
    /// The checksum is another: the bytes are damaged.
    Checksum {
        /// As it stands there.
        stored: u32,
        /// As it should be.
        computed: u32,
    },
    /// Another version, written by a firmware newer or older than this.
    Version(u8),
    /// Bits are set that mean nothing in this version.
    UnknownPart(u8),
    /// A value is not a number, or far beyond what can be meant.
    Value {
        /// Offset of its first byte.
        offset: usize,
    },
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(bytes) => write!(f, "{bytes} bytes instead of {LENGTH}: calibrate again"),
            Self::Empty => f.write_str("no calibration kept: calibrate"),
            Self::NotARecord => f.write_str("no calibration but something else: calibrate again"),
            Self::Checksum { stored, computed } => write!(
                f,
                "checksum {stored:08x} instead of {computed:08x}, damaged: calibrate again"
            ),
            Self::Version(version) => {
                write!(
                    f,
                    "version {version} instead of {VERSION}: calibrate again with this firmware"
                )
            }
            Self::UnknownPart(bits) => write!(f, "unknown parts {bits:#04x}: calibrate again"),
            Self::Value { offset } => {
                write!(f, "value at byte {offset} cannot be meant: calibrate again")
            }
        }
    }
}

impl core::error::Error for RecordError {}

impl Record {
    /// What to apply. What is missing is left as the sensor reports it.
    pub fn correction(&self) -> Correction<f32> {
        let mut correction = Correction::none();
        if let Some(gyro) = self.gyro {
            correction = correction.with_gyro(GyroBias::new(gyro.bias));
        }
        if let Some(accelerometer) = &self.accelerometer {
            correction = correction.with_accelerometer(accelerometer);
        }
        if let Some(magnetometer) = &self.magnetometer {
            correction = correction.with_magnetometer(magnetometer);
        }
        correction
    }

    /// The bytes to keep.
    pub fn to_bytes(&self) -> [u8; LENGTH] {
        let mut bytes = [0; LENGTH];
        bytes[..2].copy_from_slice(&MAGIC);
        bytes[2] = VERSION;
        let Self {
            gyro,
            accelerometer,
            magnetometer,
        } = self;
        if let Some(gyro) = gyro {
            bytes[3] |= GYRO;
            let bias = gyro.bias.rad_per_s();
            let values = bias.iter().chain([&gyro.temperature_celsius]);
            write(&mut bytes[4..20], values);
        }
        if let Some(result) = accelerometer {
            bytes[3] |= ACCELEROMETER;
            let (bias, rows) = (result.bias.m_per_s2(), result.matrix.transpose());
            let placing = result.placing.rad();
            let figures = [&result.residual, &placing, &result.temperature_celsius];
            write(&mut bytes[20..80], bias.iter().chain(&rows).chain(figures));
        }
        if let Some(result) = magnetometer {
            bytes[3] |= MAGNETOMETER;
            let (hard, soft) = (result.hard_iron.microtesla(), &result.soft_iron);
            let soft = [0, 1, 2, 4, 5, 8].map(|element| soft[element]);
            let hole = result.largest_hole.rad();
            let figures = [
                &result.strength_microtesla,
                &result.error_percent,
                &result.coverage,
                &hole,
                &result.temperature_celsius,
            ];
            write(
                &mut bytes[80..BODY],
                hard.iter().chain(&soft).chain(figures),
            );
        }
        let checksum = crc32(&bytes[..BODY]);
        bytes[BODY..].copy_from_slice(&checksum.to_le_bytes());
        bytes
    }

    /// What was kept.
    ///
    /// # Errors
    ///
    /// A [`RecordError`]: bytes of another length, damaged, of another version, or with values that no
    /// procedure here makes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, RecordError> {
        let whole: &[u8; LENGTH] = bytes
            .try_into()
            .map_err(|_| RecordError::Length(bytes.len()))?;
        if [0x00, 0xFF]
            .iter()
            .any(|blank| whole.iter().all(|byte| byte == blank))
        {
            return Err(RecordError::Empty);
        }
        if whole[..2] != MAGIC {
            return Err(RecordError::NotARecord);
        }
        // Before the checksum, which may stand elsewhere in another version.
        if whole[2] != VERSION {
            return Err(RecordError::Version(whole[2]));
        }
        let (body, stored) = whole.split_at(BODY);
        let stored = stored
            .iter()
            .rev()
            .fold(0, |word, &byte| word << 8 | u32::from(byte));
        let computed = crc32(body);
        if stored != computed {
            return Err(RecordError::Checksum { stored, computed });
        }
        let parts = body[3];
        if parts & !(GYRO | ACCELEROMETER | MAGNETOMETER) != 0 {
            return Err(RecordError::UnknownPart(parts));
        }
        Ok(Self {
            gyro: (parts & GYRO != 0).then(|| gyro(body)).transpose()?,
            accelerometer: (parts & ACCELEROMETER != 0)
                .then(|| accelerometer(body))
                .transpose()?,
            magnetometer: (parts & MAGNETOMETER != 0)
                .then(|| magnetometer(body))
                .transpose()?,
        })
    }
}

fn gyro(body: &[u8]) -> Result<Gyro, RecordError> {
    let [x, y, z, temperature_celsius] = values(body, 4)?;
    plausible([x, y, z], -0.35..=0.35, 4)?;
    Ok(Gyro {
        bias: AngularRate::from_rad_per_s(Vector3::new(x, y, z)),
        temperature_celsius,
    })
}

fn accelerometer(body: &[u8]) -> Result<Accelerometer<f32>, RecordError> {
    let bias: [f32; 3] = values(body, 20)?;
    let matrix: [f32; 9] = values(body, 32)?;
    let [residual, placing, temperature_celsius] = values(body, 68)?;
    plausible(bias, -3.0..=3.0, 20)?;
    let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = matrix;
    plausible([xx, yy, zz], 0.8..=1.25, 32)?;
    plausible([xy, xz, yx, yz, zx, zy], -0.1..=0.1, 36)?;
    plausible([residual], 0.0..=0.2, 68)?;
    Ok(Accelerometer {
        bias: SpecificForce::from_m_per_s2(bias.into()),
        matrix: Matrix3::from_row_slice(&matrix),
        residual,
        placing: Angle::from_rad(placing),
        temperature_celsius,
    })
}

fn magnetometer(body: &[u8]) -> Result<Magnetometer<f32>, RecordError> {
    let hard: [f32; 3] = values(body, 80)?;
    let [xx, xy, xz, yy, yz, zz] = values(body, 92)?;
    let [strength, error, coverage, hole, temperature_celsius] = values(body, 116)?;
    plausible(hard, -2000.0..=2000.0, 80)?;
    plausible([xx, yy, zz], 0.3..=3.0, 92)?;
    plausible([xy, xz, yz], -1.0..=1.0, 96)?;
    plausible([strength], 20.0..=70.0, 116)?;
    plausible([error], 0.0..=10.0, 120)?;
    plausible([coverage], 0.0..=1.0, 124)?;
    Ok(Magnetometer {
        hard_iron: MagneticField::from_microtesla(hard.into()),
        soft_iron: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        strength_microtesla: strength,
        error_percent: error,
        coverage,
        largest_hole: Angle::from_rad(hole),
        temperature_celsius,
    })
}

/// Whatever made the record, a sensor that works has nothing beyond these: wider than what the
/// procedures accept, far narrower than what would stop a picture.
fn plausible<const N: usize>(
    values: [f32; N],
    range: RangeInclusive<f32>,
    offset: usize,
) -> Result<(), RecordError> {
    if values.iter().all(|value| range.contains(value)) {
        return Ok(());
    }
    Err(RecordError::Value { offset })
}

fn write<'a>(bytes: &mut [u8], values: impl Iterator<Item = &'a f32>) {
    for (bytes, value) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(values) {
        *bytes = value.to_le_bytes();
    }
}

fn values<const N: usize>(body: &[u8], start: usize) -> Result<[f32; N], RecordError> {
    let words = body.get(start..).unwrap_or_default().as_chunks::<4>().0;
    let mut values = [0.0; N];
    for (index, (value, bytes)) in values.iter_mut().zip(words).enumerate() {
        *value = f32::from_le_bytes(*bytes);
        // Written so that what is not a number is not within.
        let within = value.abs() <= LARGEST;
        if !within {
            let offset = start + 4 * index;
            return Err(RecordError::Value { offset });
        }
    }
    Ok(values)
}

/// CRC-32/ISO-HDLC. A bit at a time: it runs at start and when something is kept.
pub fn crc32(bytes: &[u8]) -> u32 {
    let crc = bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            crc >> 1 ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 }
        })
    });
    !crc
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_checksum_is_the_one_of_the_catalogues() {
        assert_eq!(super::crc32(b"123456789"), 0xCBF4_3926);
    }
}
