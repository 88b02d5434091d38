//! Where an orientation comes from: which one it is, of which moment, and how far it is to be trusted.

/// Which orientation, and of which moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stamp {
    /// One more with every orientation that was made ready for the host, 0 after 65535. A number that
    /// is missing was dropped because the host did not read, or lost on the way.
    pub sequence: u16,
    /// Device time at which the sensor had the sample ready, in µs since the start; 0 after
    /// 4294967295, which is 71.6 minutes.
    pub micros: u32,
}

/// Everything a binary frame says about an orientation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Which, and when.
    pub stamp: Stamp,
    /// How far to be trusted.
    pub status: Status,
}

/// What was going on when the orientation was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status {
    /// The sensor had no new sample: the one before was used again.
    pub repeated: bool,
    /// An axis stood at the end of the sensor's range.
    pub clipped: bool,
    /// The board is at rest, as far as the default estimator can tell; never with another.
    pub still: bool,
    /// What the magnetometer does for the heading.
    pub compass: Compass,
    /// The notes' estimator made it, not the default one.
    pub notes: bool,
    /// The gyro's bias has been measured at rest since the start.
    pub bias_measured: bool,
    /// Samples between the one before and this one were left out or lost.
    pub skipped: bool,
}

/// What the magnetometer does for the heading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compass {
    /// Nothing has come from it for a second, or there is none.
    #[default]
    Absent,
    /// It is not followed: not calibrated, switched off, or not for this estimator.
    Unused,
    /// The heading follows it.
    Followed,
    /// Something magnetic is near: the gyro keeps the heading.
    Disturbed,
}

const REPEATED: u8 = 1;
const CLIPPED: u8 = 1 << 1;
const STILL: u8 = 1 << 2;
/// Of two bits.
const COMPASS: u32 = 3;
const NOTES: u8 = 1 << 5;
const BIAS_MEASURED: u8 = 1 << 6;
const SKIPPED: u8 = 1 << 7;

impl Status {
    /// As a byte of a frame.
    pub fn to_byte(self) -> u8 {
        let flag = |set: bool, bit: u8| if set { bit } else { 0 };
        let compass = match self.compass {
            Compass::Absent => 0,
            Compass::Unused => 1,
            Compass::Followed => 2,
            Compass::Disturbed => 3,
        };
        flag(self.repeated, REPEATED)
            | flag(self.clipped, CLIPPED)
            | flag(self.still, STILL)
            | compass << COMPASS
            | flag(self.notes, NOTES)
            | flag(self.bias_measured, BIAS_MEASURED)
            | flag(self.skipped, SKIPPED)
    }

    /// From a byte of a frame.
    pub fn from_byte(byte: u8) -> Self {
        let flag = |bit: u8| byte & bit != 0;
        Self {
            repeated: flag(REPEATED),
            clipped: flag(CLIPPED),
            still: flag(STILL),
            compass: match byte >> COMPASS & 3 {
                0 => Compass::Absent,
                1 => Compass::Unused,
                2 => Compass::Followed,
                _ => Compass::Disturbed,
            },
            notes: flag(NOTES),
            bias_measured: flag(BIAS_MEASURED),
            skipped: flag(SKIPPED),
        }
    }
}
