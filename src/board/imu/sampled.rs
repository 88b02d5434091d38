//! What sampling brings.

use vrduino::imu::magnetometer::polling::Loss;
use vrduino::sampling::Timing;
use vrduino::sensor::magnetometer::RawField;

use super::super::dma::Bytes;
use super::super::i2c::Error;

/// How a read has ended.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// With a new sample.
    New,
    /// The sensor had nothing new.
    Nothing,
    /// There was none.
    Failed(Error),
}

/// What a period of the sensor has brought.
pub struct Sampled {
    /// Whether there is a burst.
    pub outcome: Outcome,
    /// From the IMU.
    pub bytes: Bytes,
    /// When that was ready.
    pub timing: Timing,
    /// From the magnetometer, mostly nothing; that it is lost is said once.
    pub field: Option<Result<RawField, Loss>>,
}

/// What the interrupts have counted since the start.
#[derive(Clone, Copy, Default)]
pub struct Counts {
    /// Samples that were never read, or found no room in the queue.
    pub lost: u32,
    /// Times that the magnetometer's measurements were overwritten unread.
    pub skipped_fields: u32,
}
