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
use core::fmt::{self, Write};
use heapless::String;
use nalgebra::{Matrix3, Vector3};

/// Bytes of a record.
pub const LENGTH: usize = BODY + 4;

const BODY: usize = 136;
const MAGIC: [u8; 2] = *b"VC";
const VERSION: u8 = 1;

/// One of the three results: where it lies, and what its numbers can be.
struct Part {
    /// In byte 3.
    bit: u8,
    start: usize,
    /// So many numbers one after the other, from and to.
    limits: &'static [(u8, f32, f32)],
}

// Whatever made the record, a sensor that works has nothing beyond these: wider than what the procedures
// accept, far narrower than what would stop a picture.
const GYRO: Part = Part {
    bit: 1 << 0,
    start: 4,
    limits: &[(3, -0.35, 0.35), ANY],
};
const ACCELEROMETER: Part = Part {
    bit: 1 << 1,
    start: 20,
    limits: &[
        (3, -3.0, 3.0),
        (1, 0.8, 1.25),
        (3, -0.1, 0.1),
        (1, 0.8, 1.25),
        (3, -0.1, 0.1),
        (1, 0.8, 1.25),
        (1, 0.0, 0.2),
        ANY,
        ANY,
    ],
};
const MAGNETOMETER: Part = Part {
    bit: 1 << 2,
    start: 80,
    limits: &[
        (3, -2000.0, 2000.0),
        (1, 0.3, 3.0),
        (2, -1.0, 1.0),
        (1, 0.3, 3.0),
        (1, -1.0, 1.0),
        (1, 0.3, 3.0),
        (1, 20.0, 70.0),
        (1, 0.0, 10.0),
        (1, 0.0, 1.0),
        ANY,
        ANY,
    ],
};
/// No value of any calibration is larger, in any unit used here.
const ANY: (u8, f32, f32) = (1, -10_000.0, 10_000.0);

/// A line by which a record is handed over.
pub type KeepLine = String<64>;

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
        if let Some(gyro) = &self.gyro {
            let mut part = Writer::new(&mut bytes, GYRO);
            part.vector(&gyro.bias.rad_per_s());
            part.number(gyro.temperature_celsius);
        }
        if let Some(result) = &self.accelerometer {
            let mut part = Writer::new(&mut bytes, ACCELEROMETER);
            part.vector(&result.bias.m_per_s2());
            for row in 0..3 {
                part.vector(&result.matrix.row(row).transpose());
            }
            part.number(result.residual);
            part.number(result.placing.rad());
            part.number(result.temperature_celsius);
        }
        if let Some(result) = &self.magnetometer {
            let mut part = Writer::new(&mut bytes, MAGNETOMETER);
            part.vector(&result.hard_iron.microtesla());
            for element in [0, 1, 2, 4, 5, 8] {
                part.number(result.soft_iron[element]);
            }
            part.number(result.strength_microtesla);
            part.number(result.error_percent);
            part.number(result.coverage);
            part.number(result.largest_hole.rad());
            part.number(result.temperature_celsius);
        }
        let checksum = crc32(&bytes[..BODY]);
        bytes[BODY..].copy_from_slice(&checksum.to_le_bytes());
        bytes
    }

    /// What a host types to hand it to a board, line by line without their ends: `:keep AT HEX` for each
    /// 24 bytes, and `:keep done`.
    pub fn lines(&self) -> impl Iterator<Item = KeepLine> {
        const PIECE: usize = 24;
        let bytes = self.to_bytes();
        let pieces = (0..LENGTH).step_by(PIECE).map(move |at| {
            let mut line = KeepLine::new();
            // 10 characters and two for each byte: there is room.
            let _ = write!(line, ":keep {at} ");
            for byte in bytes.iter().skip(at).take(PIECE) {
                let _ = write!(line, "{byte:02x}");
            }
            line
        });
        pieces.chain(KeepLine::try_from(":keep done"))
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
        if parts & !(GYRO.bit | ACCELEROMETER.bit | MAGNETOMETER.bit) != 0 {
            return Err(RecordError::UnknownPart(parts));
        }
        let part = |part: Part| Reader::of(body, &part);
        Ok(Self {
            gyro: part(GYRO)?.map(gyro),
            accelerometer: part(ACCELEROMETER)?.map(accelerometer),
            magnetometer: part(MAGNETOMETER)?.map(magnetometer),
        })
    }
}

fn gyro(mut part: Reader<'_>) -> Gyro {
    Gyro {
        bias: AngularRate::from_rad_per_s(part.vector()),
        temperature_celsius: part.number(),
    }
}

fn accelerometer(mut part: Reader<'_>) -> Accelerometer<f32> {
    Accelerometer {
        bias: SpecificForce::from_m_per_s2(part.vector()),
        matrix: Matrix3::from_columns(&[part.vector(), part.vector(), part.vector()]).transpose(),
        residual: part.number(),
        placing: Angle::from_rad(part.number()),
        temperature_celsius: part.number(),
    }
}

fn magnetometer(mut part: Reader<'_>) -> Magnetometer<f32> {
    let hard_iron = MagneticField::from_microtesla(part.vector());
    let [xx, xy, xz]: [f32; 3] = part.vector().into();
    let [yy, yz, zz]: [f32; 3] = part.vector().into();
    Magnetometer {
        hard_iron,
        soft_iron: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        strength_microtesla: part.number(),
        error_percent: part.number(),
        coverage: part.number(),
        largest_hole: Angle::from_rad(part.number()),
        temperature_celsius: part.number(),
    }
}

/// Puts one number behind the other.
struct Writer<'a>(core::slice::IterMut<'a, [u8; 4]>);

impl<'a> Writer<'a> {
    fn new(bytes: &'a mut [u8; LENGTH], part: Part) -> Self {
        bytes[3] |= part.bit;
        Self(bytes[part.start..].as_chunks_mut().0.iter_mut())
    }

    fn number(&mut self, value: f32) {
        if let Some(bytes) = self.0.next() {
            *bytes = value.to_le_bytes();
        }
    }

    fn vector(&mut self, vector: &Vector3<f32>) {
        vector.iter().for_each(|&value| self.number(value));
    }
}

/// Takes one number behind the other.
struct Reader<'a>(core::slice::Iter<'a, [u8; 4]>);

impl<'a> Reader<'a> {
    /// At the beginning of a part, if it is there.
    ///
    /// # Errors
    ///
    /// A number in it is beyond its limits, or is none.
    fn of(body: &'a [u8], part: &Part) -> Result<Option<Self>, RecordError> {
        if body[3] & part.bit == 0 {
            return Ok(None);
        }
        let start = Self(body[part.start..].as_chunks().0.iter());
        let mut numbers = Self(start.0.clone());
        let mut offset = part.start;
        for &(count, least, greatest) in part.limits {
            for _ in 0..count {
                if !(least..=greatest).contains(&numbers.number()) {
                    return Err(RecordError::Value { offset });
                }
                offset += 4;
            }
        }
        Ok(Some(start))
    }

    fn number(&mut self) -> f32 {
        self.0
            .next()
            .map_or(0.0, |bytes| f32::from_le_bytes(*bytes))
    }

    fn vector(&mut self) -> Vector3<f32> {
        Vector3::new(self.number(), self.number(), self.number())
    }
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
