//! The AK8963 in the MPU-9250's package: what its bytes mean (AK8963 data sheet, the registers HXL
//! to ST2 and ASAX to ASAZ; MPU-9250 product specification, orientation of axes).
//!
//! Eq. 5 of the course notes does not hold for it: with the notes' ±4800 µT it would give 0.1465 µT
//! per count, 2.3 % below the data sheet's 0.15. Each axis has a sensitivity of its own besides, a
//! factor written into a fuse ROM at the factory.

use crate::units::MagneticField;
use core::fmt;
use nalgebra::{RealField, Vector3, convert};

/// HXL (0x03): the first register of a measurement. The data must be read through to ST2.
pub const BURST_START: u8 = 0x03;

/// HXL to ST2 (0x09).
pub const BURST_LEN: usize = 7;

/// ASAX (0x10), the first of the three bytes of [`SensitivityAdjustment`]; readable in fuse ROM
/// access mode only.
pub const ADJUSTMENT_START: u8 = 0x10;

/// HOFL in ST2: |X| + |Y| + |Z| reached 4912 µT, and the counts mean nothing.
const OVERFLOW: u8 = 1 << 3;

/// BITM in ST2: the counts are those of [`Resolution::Bits16`].
const SIXTEEN_BITS: u8 = 1 << 4;

/// How fine a count is. Both cover the same range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resolution {
    /// 0.6 µT per count, −8190 to 8190.
    Bits14,
    /// 0.15 µT per count, −32760 to 32760: not all that 16 bits could hold.
    Bits16,
}

impl Resolution {
    /// The data sheet's typical sensitivity (section 8.3.4, table 8.3). The same table gives the end
    /// of the range as ±4912 µT, which is 0.04 % less than 32760 counts of 0.15 µT.
    pub const fn microtesla_per_count(self) -> f64 {
        match self {
            Self::Bits14 => 0.6,
            Self::Bits16 => 0.15,
        }
    }

    /// The same as a constant of the scalar: the board has no double precision to convert it from.
    fn scale<T: RealField>(self) -> T {
        match self {
            Self::Bits14 => convert(Self::Bits14.microtesla_per_count()),
            Self::Bits16 => convert(Self::Bits16.microtesla_per_count()),
        }
    }

    /// The largest count the part reports, of either sign.
    pub const fn largest_count(self) -> i16 {
        match self {
            Self::Bits14 => 8190,
            Self::Bits16 => 32760,
        }
    }
}

/// One measurement in counts, along the magnetometer's own axes, not yet adjusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawField {
    /// Along the magnetometer's x, y, z.
    pub counts: [i16; 3],
    /// What a count is.
    pub resolution: Resolution,
    /// The field was too strong for the sensor.
    pub overflow: bool,
}

impl RawField {
    /// Takes a burst apart. Other than those of the gyro and the accelerometer, these values are
    /// little-endian.
    pub fn from_burst(burst: &[u8; BURST_LEN]) -> Self {
        let [xl, xh, yl, yh, zl, zh, status] = *burst;
        let word = |low, high| i16::from_le_bytes([low, high]);
        Self {
            counts: [word(xl, xh), word(yl, yh), word(zl, zh)],
            resolution: if status & SIXTEEN_BITS == 0 {
                Resolution::Bits14
            } else {
                Resolution::Bits16
            },
            overflow: status & OVERFLOW != 0,
        }
    }

    /// Whether the counts are those of a field.
    ///
    /// # Errors
    ///
    /// [`FieldError`], where they are not.
    pub fn check(&self) -> Result<(), FieldError> {
        if self.overflow {
            return Err(FieldError::Overflow);
        }
        let largest = self.resolution.largest_count().unsigned_abs();
        if self.counts.iter().any(|c| c.unsigned_abs() > largest) {
            return Err(FieldError::OutOfRange);
        }
        Ok(())
    }

    /// The field in µT, in the body frame ([`to_body`]), adjusted. In place of eq. 5 of the course
    /// notes, which does not hold here.
    ///
    /// # Errors
    ///
    /// [`FieldError`], where the counts are not those of a field.
    pub fn field<T: RealField + Copy>(
        &self,
        adjustment: SensitivityAdjustment,
    ) -> Result<MagneticField<T>, FieldError> {
        self.check()?;
        let microtesla_per_count = self.resolution.scale::<T>();
        let counts = Vector3::from(self.counts.map(|c| convert(f32::from(c))));
        let own = counts.component_mul(&adjustment.factors()) * microtesla_per_count;
        Ok(MagneticField::from_microtesla(to_body(own)))
    }
}

/// Why there is no field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldError {
    /// The sensor says that the field was too strong for it.
    Overflow,
    /// A count lies beyond the end of the range, where the part reports none: the bytes are not
    /// those of a measurement.
    OutOfRange,
}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Overflow => "magnetic field of 4912 uT or more: move the board away from magnets",
            Self::OutOfRange => {
                "magnetometer counts beyond its range: read HXL to ST2 in one burst"
            }
        })
    }
}

impl core::error::Error for FieldError {}

/// ASAX, ASAY and ASAZ of the fuse ROM: how sensitive each axis of this one part is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SensitivityAdjustment([u8; 3]);

impl SensitivityAdjustment {
    /// Every axis exactly as sensitive as the data sheet says.
    pub const NONE: Self = Self([128; 3]);

    /// As read from the fuse ROM, x first.
    pub const fn from_fuse_rom(asa: [u8; 3]) -> Self {
        Self(asa)
    }

    /// The same bytes again, x first.
    pub const fn fuse_rom(self) -> [u8; 3] {
        self.0
    }

    /// H_adj = H ((ASA − 128) · 0.5 / 128 + 1): from 0.5 to 1.496. Along the magnetometer's axes.
    ///
    /// That is (ASA + 128) / 256, which has no difference to take without a sign, and is exact in
    /// single precision.
    pub fn factors<T: RealField + Copy>(self) -> Vector3<T> {
        let factor = |asa: u8| convert((f32::from(asa) + 128.0) / 256.0);
        Vector3::from(self.0.map(factor))
    }
}

/// From the magnetometer's axes to the body's: (m_y, m_x, −m_z). It is its own inverse.
///
/// The course notes (figure 2) speak of “flipping the x and y coordinates”; that is exchanging
/// them, not changing their signs: only so do both right-handed frames fit the figure.
pub fn to_body<T: RealField + Copy>(own: Vector3<T>) -> Vector3<T> {
    Vector3::new(own.y, own.x, -own.z)
}
