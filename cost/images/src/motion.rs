//! Motions that go to every end of what the filter in fixed point has to stand.

use vrduino::fixed::complementary::{Bias, Complementary, Nanoseconds, Parameters};
use vrduino::fixed::multiply::Multiply;
use vrduino::orientation::{DEFAULT_TIME_CONSTANT, TimeConstant};
use vrduino::sensor::{GyroRange, RawSample};
use vrduino::units::Seconds;

/// How many samples an image takes of each kind.
pub const SAMPLES: u32 = 4000;

/// What the gyro of the motions reads at rest, in 2⁻¹⁵ counts.
const BIAS: [i32; 3] = [1_234_567, -765_432, 98_765];
/// The same in counts.
const BIAS_COUNTS: [i16; 3] = [38, -23, 3];

/// A motion, and how it is filtered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// A level board that turns about the vertical at up to 300 °/s, with noise: within 45° of level.
    Level,
    /// A board at rest under forces from everywhere up to 44° from the vertical.
    Tilted,
    /// Anything the registers can hold, each end and zero more often than by chance.
    Anything,
    /// The same with a time constant of no time at all, α = 0.
    AnythingAtOnce,
}

impl Motion {
    /// Every one.
    pub const ALL: [Self; 4] = [
        Self::Level,
        Self::Tilted,
        Self::Anything,
        Self::AnythingAtOnce,
    ];

    /// The filter at its start, at ±2000 °/s and 1 kHz.
    pub fn filter<M: Multiply>(self) -> Complementary<M> {
        let mut filter = Complementary::with(&Parameters {
            gyro: GyroRange::Dps2000,
            sample_period: Nanoseconds(1_000_000),
            time_constant: match self {
                Self::Level | Self::Tilted | Self::Anything => DEFAULT_TIME_CONSTANT,
                Self::AnythingAtOnce => TimeConstant::new(Seconds(0.0)),
            },
        });
        filter.set_bias(Bias::from_parts_of_counts(BIAS));
        filter
    }

    /// Its sample of this number; `random` goes from one to the next.
    pub fn sample(self, number: u32, random: &mut Random) -> RawSample {
        let (gyro, accel) = match self {
            Self::Level => {
                // There and back, at 1.25 Hz.
                let phase = (number % 800) as i16;
                let turn = (phase - 400).abs() * 24 - 4800;
                (
                    [0, turn, 0].map(|counts| counts + random.noise(8)),
                    [0, 16384, 0].map(|counts| counts + random.noise(300)),
                )
            }
            Self::Tilted => (
                BIAS_COUNTS.map(|counts| counts + random.noise(8)),
                [random.noise(11_000), 16_384, random.noise(11_000)],
            ),
            Self::Anything | Self::AnythingAtOnce => (
                [(); 3].map(|()| random.counts()),
                [(); 3].map(|()| random.counts()),
            ),
        };
        RawSample {
            gyro,
            accel,
            temperature: 0,
            fresh: true,
        }
    }
}

/// Reproducible random counts (xorshift32).
#[derive(Clone, Copy, Debug)]
pub struct Random(u32);

impl Default for Random {
    fn default() -> Self {
        Self(0x9E37_79B9)
    }
}

impl Random {
    fn next(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// From −`size` to just below `size`.
    pub(crate) fn noise(&mut self, size: i16) -> i16 {
        let bits = (self.next() as i32) >> 16;
        ((bits * i32::from(size)) >> 15) as i16
    }

    pub(crate) fn counts(&mut self) -> i16 {
        let bits = self.next();
        match bits & 7 {
            0 => 0,
            1 => i16::MAX,
            2 => i16::MIN,
            3 => ((bits >> 16) as i16) >> 12,
            _ => (bits >> 16) as i16,
        }
    }
}
