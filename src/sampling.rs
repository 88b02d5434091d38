//! When to read the sensor, and when what was read was measured.
//!
//! The sensor measures by its own oscillator, which is up to ±1 % off, and its INT pin is not wired on a VRduino. All
//! that a read tells is one bit: whether there was a new sample. [`data_ready`] makes of these bits when each sample
//! was ready, to a fraction of a microsecond, and when the next one is to be asked for, so that every sample is read
//! once and soon.
//!
//! Times are those of the board's crystal. Nothing here knows a timer: moments come in as counts of a clock that runs
//! freely and wraps, and go out the same way.
//!
//! [`data_ready`]: crate::sampling::data_ready

pub mod data_ready;

/// When a sample was ready, by the board's crystal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timing {
    /// Data-ready, in microseconds since the board started.
    pub micros: u64,
    /// The sensor's period as it was measured, in nanoseconds: the time between two samples.
    pub period_ns: u32,
    /// Samples that the sensor took since the one before and that were never read; this one among them if it could not
    /// be read and repeats the one before.
    pub lost: u32,
    /// Whether the sensor's clock is known: else `micros` may be off by tenths of a millisecond, and `period_ns` by one
    /// per cent.
    pub locked: bool,
}

/// What decides when the sensor is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lock {
    /// The sensor's data-ready: every sample is read once.
    #[default]
    Sensor,
    /// The host's start of frame: a sample a millisecond by the host's clock, at the same time in each frame. Now and
    /// then one comes twice or is left out.
    Usb,
}

impl Lock {
    /// As it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sensor => "sensor",
            Self::Usb => "usb",
        }
    }
}
