//! The AK8963, the magnetometer in the sensor's package: found, set up, and asked in time. What its
//! bytes mean is told in [`crate::sensor::magnetometer`].
//!
//! It is a die of its own on an auxiliary bus, and there are two ways to it. The sensor's auxiliary
//! master can copy its registers behind those of the gyro at every sample. Such a copy is taken by
//! the sensor's clock and read by the board's, so a DRDY in it is seen twice or not at all; and the
//! magnetometer skips a measurement that ends while its data is being read (data sheet, section
//! 6.4.3), which at a thousand blind reads a second is one in six. So the bypass is used: it
//! joins the two buses, the board asks the magnetometer itself, reads data only after DRDY, and
//! DRDY is cleared by that very read. None is lost, and none is new twice.

use super::ADDRESS as IMU;
use crate::sensor::magnetometer::{ADJUSTMENT_START, SensitivityAdjustment};
use core::fmt;
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::I2c;
use polling::Loss;

/// When it is asked, and whether it still measures.
pub mod polling;

/// Its I²C address in the MPU-9250.
pub const ADDRESS: u8 = 0x0C;

// Of the MPU-9250: register map, sections 4.20 and 4.33.
const INT_PIN_CFG: u8 = 0x37;
const BYPASS_EN: u8 = 1 << 1;
const USER_CTRL: u8 = 0x6A;

// Of the AK8963: data sheet, section 8.
const WIA: u8 = 0x00;
const IDENTITY: u8 = 0x48;
const CNTL1: u8 = 0x0A;
const CNTL2: u8 = 0x0B;
const SOFT_RESET: u8 = 1;
const FUSE_ROM: u8 = 0b0000_1111;
const POWER_DOWN: u8 = 0;
/// Continuous measurement mode 2: 100 Hz, 16 bits.
const MEASURE: u8 = 0b0001_0110;

/// From power-down to another mode at least 100 µs must pass (data sheet, section 6.3).
const MODE_WAIT_US: u32 = 200;

/// Why there is no compass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MagnetometerError<E> {
    /// The bus reported this error: mostly that nobody is there. An MPU-6500 has none.
    NoAnswer(E),
    /// Something answers, but its WIA is this.
    UnknownPart(u8),
    /// The fuse ROM, where the factory writes how sensitive each axis is, is empty.
    BlankFuseRom,
    /// It did not take its mode.
    NotMeasuring {
        /// What CNTL1 holds.
        read: u8,
    },
    /// It was set up and did measure.
    Lost(Loss),
}

impl<E> fmt::Display for MagnetometerError<E> {
    /// Goes on after “Magnetometer:”, in at most 70 bytes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAnswer(_) => f.write_str("none"),
            Self::UnknownPart(id) => {
                write!(f, "unknown part 0x{id:02X} at I2C address 0x0C, want 0x48")
            }
            Self::BlankFuseRom => f.write_str("its fuse ROM is blank"),
            Self::NotMeasuring { read } => write!(
                f,
                "register 0x{CNTL1:02X} holds 0x{read:02X}, wrote 0x{MEASURE:02X}"
            ),
            Self::Lost(loss) => loss.fmt(f),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for MagnetometerError<E> {}

/// Sets the magnetometer up for 100 Hz and 16 bits; measuring begins at once. To be called behind
/// [`configure`](super::configure), whose reset closes the way to it.
///
/// Without a magnetometer the way is closed again: whatever hangs on the auxiliary pins has no
/// business on the sensor's bus.
pub fn set_up<B: I2c, D: DelayNs>(
    bus: &mut B,
    delay: &mut D,
) -> Result<SensitivityAdjustment, MagnetometerError<B::Error>> {
    let result = start(bus, delay);
    if result.is_err() {
        // The error that is told is the first.
        let _ = bus.write(IMU, &[INT_PIN_CFG, 0]);
    }
    result
}

fn start<B: I2c, D: DelayNs>(
    bus: &mut B,
    delay: &mut D,
) -> Result<SensitivityAdjustment, MagnetometerError<B::Error>> {
    // The bypass is open only while the auxiliary master is off.
    bus.write(IMU, &[USER_CTRL, 0])?;
    bus.write(IMU, &[INT_PIN_CFG, BYPASS_EN])?;
    match read(bus, WIA)? {
        [IDENTITY] => {}
        [other] => return Err(MagnetometerError::UnknownPart(other)),
    }
    // It keeps its mode when only the processor, or only the other die, was restarted.
    bus.write(ADDRESS, &[CNTL2, SOFT_RESET])?;
    delay.delay_us(MODE_WAIT_US);
    bus.write(ADDRESS, &[CNTL1, FUSE_ROM])?;
    let asa: [u8; 3] = read(bus, ADJUSTMENT_START)?;
    bus.write(ADDRESS, &[CNTL1, POWER_DOWN])?;
    // A fuse that was never written reads as one of these; either would be half or half again.
    if asa.iter().any(|&axis| axis == 0 || axis == u8::MAX) {
        return Err(MagnetometerError::BlankFuseRom);
    }
    delay.delay_us(MODE_WAIT_US);
    bus.write(ADDRESS, &[CNTL1, MEASURE])?;
    match read(bus, CNTL1)? {
        [MEASURE] => Ok(SensitivityAdjustment::from_fuse_rom(asa)),
        [read] => Err(MagnetometerError::NotMeasuring { read }),
    }
}

fn read<B: I2c, const N: usize>(bus: &mut B, register: u8) -> Result<[u8; N], B::Error> {
    let mut bytes = [0; N];
    bus.write_read(ADDRESS, &[register], &mut bytes)?;
    Ok(bytes)
}

impl<E> From<E> for MagnetometerError<E> {
    fn from(error: E) -> Self {
        Self::NoAnswer(error)
    }
}
