//! What the sensor's bus is used for.

use vrduino::imu::magnetometer::polling::{self, Request};
use vrduino::imu::{ADDRESS, magnetometer};
use vrduino::sensor::{BURST_LEN, BURST_START};

/// A read.
#[derive(Clone, Copy)]
pub enum Job {
    /// A burst of the IMU.
    Sample,
    /// A question to the magnetometer, behind it.
    Field(Request),
}

impl Job {
    /// Of the chip.
    #[inline(always)]
    pub fn address(self) -> u8 {
        match self {
            Job::Sample => ADDRESS,
            Job::Field(_) => magnetometer::ADDRESS,
        }
    }

    /// The first register.
    #[inline(always)]
    pub fn register(self) -> u8 {
        match self {
            Job::Sample => BURST_START,
            Job::Field(_) => polling::START,
        }
    }

    /// Bytes to read.
    #[inline(always)]
    pub fn length(self) -> usize {
        match self {
            Job::Sample => BURST_LEN,
            Job::Field(request) => request.length(),
        }
    }
}
