//! Set-up is done by the crate `mpu9250`, which speaks embedded-hal 0.2 while this library speaks
//! 1.0: this is the one file where the two meet. The magnetometer in the same package is set up by
//! [`magnetometer`](crate::imu::magnetometer), since that crate takes its sensitivity without a sign
//! and asks for neither DRDY nor overflow.
//!
//! What that crate does is checked, not trusted. Its first two writes (they stop the auxiliary
//! bus, in case only the processor was restarted) ignore errors, and a sensor whose supply dipped
//! comes back silently at ±250 °/s and ±2 g. So the registers that give counts their meaning are
//! read back, after set-up and whenever [`verify`](crate::imu::verify) is called.
//!
//! The INT pin is not wired on a VRduino. Samples are fetched by a timer that follows the sensor
//! ([`sampling`](crate::sampling)), and the status register that comes with them says whether they are new.

use crate::sensor::{AccelRange, BURST_LEN, BURST_START, GyroRange, Ranges, RawSample};
use core::fmt;
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::I2c;
use embedded_hal_compat::{ReverseCompat, eh0_2};
use mpu9250::{AccelDataRate, AccelScale, Dlpf, GyroScale, GyroTempDataRate, I2CError};
use mpu9250::{InterruptEnable, Mpu9250, MpuConfig};

pub mod magnetometer;

/// The sensor's I²C address with its AD0 pin low, as on the VRduino.
pub const ADDRESS: u8 = 0x68;

/// What [`configure`] sets: the widest of each, so that neither a turn of the head nor a knock
/// reaches the end of the scale. (The course's firmware uses the same.)
pub const RANGES: Ranges = Ranges {
    gyro: GyroRange::Dps2000,
    accel: AccelRange::G16,
};

// Register map, section 3.
const SMPLRT_DIV: u8 = 0x19;
const CONFIG: u8 = 0x1A;
const WHO_AM_I: u8 = 0x75;

/// What the registers from CONFIG (0x1A) on must hold: the value, and the bits that have a
/// meaning. What is read in the others differs between parts.
const EXPECTED: [(u8, u8); 4] = [
    (0b0000_0001, 0b0111_1111), // CONFIG: no FSYNC, DLPF_CFG 1 (184 Hz, sampled at 1 kHz)
    (0b0001_1000, 0b1111_1011), // GYRO_CONFIG: no self-test, ±2000 °/s, filter in use
    (0b0001_1000, 0b1111_1000), // ACCEL_CONFIG: no self-test, ±16 g
    (0b0000_0001, 0b0000_1111), // ACCEL_CONFIG_2: A_DLPF_CFG 1 (218 Hz, sampled at 1 kHz)
];

/// The parts that answer at this address and share these registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// WHO_AM_I 0x71.
    Mpu9250,
    /// WHO_AM_I 0x73: differs in the name.
    Mpu9255,
    /// WHO_AM_I 0x70, often sold as an MPU-9250: no magnetometer, as a rule.
    Mpu6500,
}

/// What can go wrong with the sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImuError<E> {
    /// The bus reported this error: no acknowledge, or a fault on the wires.
    NoAnswer(E),
    /// Something answers, but its WHO_AM_I is this.
    UnknownPart(u8),
    /// A register does not hold what was written to it.
    NotConfigured {
        /// Address of the register.
        register: u8,
        /// What set-up put there.
        wrote: u8,
        /// What it holds.
        read: u8,
    },
    /// The set-up crate gave up for a reason it has for other ways of using it.
    SetUp,
}

impl<E> fmt::Display for ImuError<E> {
    /// A sentence of at most 90 bytes that says what to do about it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAnswer(_) => {
                f.write_str("no IMU answers at I2C address 0x68: check 3V3, GND, SDA 18, SCL 19")
            }
            Self::UnknownPart(id) => write!(
                f,
                "unknown part 0x{id:02X} at I2C address 0x68: want MPU-9250, MPU-9255 or MPU-6500"
            ),
            Self::NotConfigured {
                register,
                wrote,
                read,
            } => write!(
                f,
                "IMU register 0x{register:02X} holds 0x{read:02X}, wrote 0x{wrote:02X}: check its 3V3 supply"
            ),
            Self::SetUp => f.write_str("IMU set-up failed: unplug the board and plug it in again"),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for ImuError<E> {}

/// Asks who is there.
pub fn probe<B: I2c>(bus: &mut B) -> Result<Part, ImuError<B::Error>> {
    let mut id = [0];
    bus.write_read(ADDRESS, &[WHO_AM_I], &mut id)
        .map_err(ImuError::NoAnswer)?;
    match id {
        [0x71] => Ok(Part::Mpu9250),
        [0x73] => Ok(Part::Mpu9255),
        [0x70] => Ok(Part::Mpu6500),
        [other] => Err(ImuError::UnknownPart(other)),
    }
}

/// Resets the sensor, sets it to 1 kHz and [`RANGES`], and reads the settings back.
///
/// Takes a little over 100 ms, which is the time the part needs after its reset.
pub fn configure<B: I2c, D: DelayNs>(
    bus: &mut B,
    delay: &mut D,
) -> Result<Ranges, ImuError<B::Error>> {
    let mut config = MpuConfig::imu();
    // Filter 1 is the widest that samples at 1 kHz; 0 and 7 run at 8 kHz and ignore the divisor.
    config
        .gyro_scale(GyroScale::_2000DPS)
        .accel_scale(AccelScale::_16G)
        .gyro_temp_data_rate(GyroTempDataRate::DlpfConf(Dlpf::_1))
        .accel_data_rate(AccelDataRate::DlpfConf(Dlpf::_1))
        .sample_rate_divisor(0);
    let mut driver = Mpu9250::imu((&mut *bus).reverse(), &mut Milliseconds(delay), &mut config)
        .map_err(|error| match error {
            mpu9250::Error::BusError(error) => bus_error(error),
            mpu9250::Error::InvalidDevice(id) => ImuError::UnknownPart(id),
            _ => ImuError::SetUp,
        })?;
    // Some readings of the register map raise the status bit only while its interrupt is enabled.
    driver
        .enable_interrupts(InterruptEnable::RAW_RDY_EN)
        .map_err(bus_error)?;
    verify(bus)?;
    Ok(RANGES)
}

/// Reads the settings back. A sensor that lost its supply for a moment answers as if nothing had
/// happened, at an eighth of the range: its counts would be read eight times too large.
pub fn verify<B: I2c>(bus: &mut B) -> Result<(), ImuError<B::Error>> {
    let mut found = [0; EXPECTED.len()];
    bus.write_read(ADDRESS, &[CONFIG], &mut found)
        .map_err(ImuError::NoAnswer)?;
    for ((register, (wrote, meaningful)), read) in (CONFIG..).zip(EXPECTED).zip(found) {
        if read & meaningful != wrote {
            return Err(ImuError::NotConfigured {
                register,
                wrote,
                read,
            });
        }
    }
    let mut divisor = [0];
    bus.write_read(ADDRESS, &[SMPLRT_DIV], &mut divisor)
        .map_err(ImuError::NoAnswer)?;
    match divisor {
        [0] => Ok(()),
        [read] => Err(ImuError::NotConfigured {
            register: SMPLRT_DIV,
            wrote: 0,
            read,
        }),
    }
}

/// Fetches one sample and waits for it: 0.4 ms on a 400 kHz bus.
pub fn read_sample<B: I2c>(bus: &mut B) -> Result<RawSample, ImuError<B::Error>> {
    let mut burst = [0; BURST_LEN];
    bus.write_read(ADDRESS, &[BURST_START], &mut burst)
        .map_err(ImuError::NoAnswer)?;
    Ok(RawSample::from_burst(&burst))
}

fn bus_error<E>(error: I2CError<E>) -> ImuError<E> {
    match error {
        I2CError::BusError(error) => ImuError::NoAnswer(error),
        I2CError::WriteManyError => ImuError::SetUp,
    }
}

/// An embedded-hal 1.0 delay as the 0.2 trait that `mpu9250` asks for; `embedded_hal_compat` has
/// this for every width but `u8`.
struct Milliseconds<'a, D>(&'a mut D);

impl<D: DelayNs> eh0_2::blocking::delay::DelayMs<u8> for Milliseconds<'_, D> {
    fn delay_ms(&mut self, ms: u8) {
        self.0.delay_ms(u32::from(ms));
    }
}
