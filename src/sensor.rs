//! The MPU-9250 reports signed 16-bit counts; what a count is worth depends on the range it was
//! told to use. Register numbers and bits are those of the register map (RM-MPU-9250A-00), the
//! values per count those of the data sheet (PS-MPU-9250A-01, tables 1 and 2).
//!
//! Raw counts ([`RawSample`]) and physical values ([`Sample`]) are different types, so
//! “converted twice” and “not converted” do not compile. Gyro and accelerometer share one die and
//! its right-handed axes, which are the body frame: nothing is swapped or negated. The
//! magnetometer is another die with other axes and another scale: [`magnetometer`].
//!
//! The way back, from the truth to what a sensor with faults would report, is [`measurement`] and
//! [`simulation`].
//!
//! [`RawSample`]: crate::sensor::RawSample
//! [`Sample`]: crate::sensor::Sample
//! [`magnetometer`]: crate::sensor::magnetometer
//! [`measurement`]: crate::sensor::measurement
//! [`simulation`]: crate::sensor::simulation

use crate::units::{AngularRate, METRES_PER_S2_PER_G, RADIANS_PER_DEGREE, SpecificForce};
use nalgebra::{RealField, Vector3, convert, try_convert};

pub mod magnetometer;

pub mod measurement;

pub mod simulation;

/// INT_STATUS: the first register of the burst that makes up a sample.
pub const BURST_START: u8 = 0x3A;

/// INT_STATUS (0x3A) to GYRO_ZOUT_L (0x48): status, accelerometer, temperature, gyro.
pub const BURST_LEN: usize = 15;

/// The bytes of one sample as they come off the bus.
///
/// Reading the status in the same burst as the data tells, at the price of one byte, whether the
/// data is new; and it is the whole burst because the sensor holds its output registers still
/// during one, so that no half of a sample comes from the next.
pub type Burst = [u8; BURST_LEN];

/// RAW_DATA_RDY_INT in INT_STATUS: the output registers hold a sample not yet read.
pub const RAW_DATA_READY: u8 = 1 << 0;

/// Counts per full range: 2¹⁵.
///
/// Eq. 5 of the course notes divides by 2¹⁵ − 1. The data sheet does not: at ±2000 °/s it gives
/// 16.4 counts per °/s, and 32768 / 2000 = 16.384. With the printed divisor −32768 would be
/// −2000.06 °/s, outside the range it is the end of.
const COUNTS_PER_RANGE: f64 = 32768.0;

/// One sample in counts, body frame: raw_sensor_value of eq. 5, −2¹⁵ to 2¹⁵ − 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RawSample {
    /// Angular rate about x, y, z.
    pub gyro: [i16; 3],
    /// Specific force along x, y, z.
    pub accel: [i16; 3],
    /// Temperature of the die; see [`RawSample::temperature_celsius`].
    pub temperature: i16,
    /// False if the sensor had nothing new: the values repeat those of the burst before.
    pub fresh: bool,
}

impl RawSample {
    /// Takes a burst apart. All values are big-endian.
    pub fn from_burst(burst: &Burst) -> Self {
        let [
            status,
            axh,
            axl,
            ayh,
            ayl,
            azh,
            azl,
            th,
            tl,
            gxh,
            gxl,
            gyh,
            gyl,
            gzh,
            gzl,
        ] = *burst;
        let word = |high, low| i16::from_be_bytes([high, low]);
        Self {
            gyro: [word(gxh, gxl), word(gyh, gyl), word(gzh, gzl)],
            accel: [word(axh, axl), word(ayh, ayl), word(azh, azl)],
            temperature: word(th, tl),
            fresh: status & RAW_DATA_READY != 0,
        }
    }

    /// The same once more, where the sensor had nothing new.
    pub fn repeated(self) -> Self {
        Self {
            fresh: false,
            ..self
        }
    }

    /// Temperature of the die in °C: counts / 333.87 + 21 (register map, registers 65 and 66;
    /// data sheet, table 3). The counts are signed: below 21 °C they are negative.
    pub fn temperature_celsius(&self) -> f32 {
        celsius(f32::from(self.temperature))
    }

    /// True if any axis stands at the end of its range: the true value may lie beyond it.
    #[inline(always)]
    pub fn clipped(&self) -> bool {
        // Both ends become the upper one. Written out, for it is asked of every sample.
        let end = |counts: i16| counts ^ (counts >> 15) == i16::MAX;
        let ([p, q, r], [x, y, z]) = (self.gyro, self.accel);
        end(p) | end(q) | end(r) | end(x) | end(y) | end(z)
    }
}

/// Full scale of the gyro (course notes, section 2), GYRO_FS_SEL in the order of the register map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GyroRange {
    /// ±250 °/s, 131 counts per °/s.
    Dps250,
    /// ±500 °/s, 65.5 counts per °/s.
    Dps500,
    /// ±1000 °/s, 32.8 counts per °/s.
    Dps1000,
    /// ±2000 °/s, 16.4 counts per °/s.
    Dps2000,
}

impl GyroRange {
    /// Every range, narrowest first.
    pub const ALL: [Self; 4] = [Self::Dps250, Self::Dps500, Self::Dps1000, Self::Dps2000];

    /// The end of the range in °/s: max_range of eq. 5.
    pub const fn max_dps(self) -> f64 {
        match self {
            Self::Dps250 => 250.0,
            Self::Dps500 => 500.0,
            Self::Dps1000 => 1000.0,
            Self::Dps2000 => 2000.0,
        }
    }

    /// Counts of 1 °/s.
    pub const fn counts_per_dps(self) -> f32 {
        match self {
            Self::Dps250 => 131.072,
            Self::Dps500 => 65.536,
            Self::Dps1000 => 32.768,
            Self::Dps2000 => 16.384,
        }
    }

    const fn rad_per_s_per_count(self) -> f64 {
        self.max_dps() * RADIANS_PER_DEGREE / COUNTS_PER_RANGE
    }
}

/// Full scale of the accelerometer (course notes, section 2), ACCEL_FS_SEL in the order of the
/// register map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccelRange {
    /// ±2 g, 16384 counts per g.
    G2,
    /// ±4 g, 8192 counts per g.
    G4,
    /// ±8 g, 4096 counts per g.
    G8,
    /// ±16 g, 2048 counts per g.
    G16,
}

impl AccelRange {
    /// Every range, narrowest first.
    pub const ALL: [Self; 4] = [Self::G2, Self::G4, Self::G8, Self::G16];

    /// The end of the range in g: max_range of eq. 5.
    pub const fn max_g(self) -> f64 {
        match self {
            Self::G2 => 2.0,
            Self::G4 => 4.0,
            Self::G8 => 8.0,
            Self::G16 => 16.0,
        }
    }

    /// Counts of 1 g.
    pub const fn counts_per_g(self) -> u16 {
        match self {
            Self::G2 => 16384,
            Self::G4 => 8192,
            Self::G8 => 4096,
            Self::G16 => 2048,
        }
    }

    const fn m_per_s2_per_count(self) -> f64 {
        self.max_g() * METRES_PER_S2_PER_G / COUNTS_PER_RANGE
    }
}

/// The ranges the sensor was set to: all that is needed to give counts a meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ranges {
    /// Of the gyro.
    pub gyro: GyroRange,
    /// Of the accelerometer.
    pub accel: AccelRange,
}

impl Ranges {
    /// Eq. 5 with the data sheet's divisor: rad/s and m/s², body frame. Every count has a value; the
    /// one at an end of the range may stand for more ([`RawSample::clipped`]).
    pub fn sample<T: RealField + Copy>(self, raw: &RawSample) -> Sample<T> {
        let vector = |counts: [i16; 3]| Vector3::from(counts.map(|c| convert(f32::from(c))));
        self.scaled(vector(raw.gyro), vector(raw.accel))
    }

    /// Eq. 5 the other way: the counts the sensor reports for these values, rounded to the nearest
    /// and clipped at the ends of the range ([`RawSample::clipped`] then says so). What is not a
    /// number becomes zero. The temperature is 21 °C, and the sample is fresh.
    pub fn counts<T: RealField + Copy>(self, sample: &Sample<T>) -> RawSample {
        let gyro = sample.rate.rad_per_s() / convert::<f64, T>(self.gyro.rad_per_s_per_count());
        let accel = sample.force.m_per_s2() / convert::<f64, T>(self.accel.m_per_s2_per_count());
        RawSample {
            gyro: gyro.map(nearest_count).into(),
            accel: accel.map(nearest_count).into(),
            temperature: 0,
            fresh: true,
        }
    }

    /// Eq. 5 for counts that are no longer whole, such as the mean of many samples.
    pub(crate) fn scaled<T: RealField + Copy>(
        self,
        gyro_counts: Vector3<T>,
        accel_counts: Vector3<T>,
    ) -> Sample<T> {
        // From counts to the unit of the equations in one multiplication.
        let rad_per_s: T = convert(self.gyro.rad_per_s_per_count());
        let m_per_s2: T = convert(self.accel.m_per_s2_per_count());
        Sample {
            rate: AngularRate::from_rad_per_s(gyro_counts * rad_per_s),
            force: SpecificForce::from_m_per_s2(accel_counts * m_per_s2),
        }
    }
}

/// One sample in physical units, body frame, as the sensor reports it: the gyro still has its
/// bias, so the estimators do not take it. [`crate::calibration::GyroBias`] turns it into a
/// reading that they do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T> {
    /// Eq. 1: true rate plus bias plus noise.
    pub rate: AngularRate<T>,
    /// Eq. 2: gravity's reaction plus acceleration plus noise.
    pub force: SpecificForce<T>,
}

/// The die's temperature for counts that need not be whole, such as the mean of many samples.
pub(crate) fn celsius(counts: f32) -> f32 {
    counts / 333.87 + 21.0
}

/// The nearest whole count that 16 bits hold. Zero for what is not a number.
fn nearest_count<T: RealField + Copy>(counts: T) -> i16 {
    // A cast to an integer saturates, which is just what the converter does.
    try_convert::<T, f64>(counts.round()).map_or(0, |counts| counts as i16)
}
