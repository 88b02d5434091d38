//! Motions for the default estimator.

use crate::motion::Random;
use vrduino::fixed::fusion::{Field, Force, Fusion, Nanoseconds, Parameters, Rates};
use vrduino::fixed::multiply::Multiply;
use vrduino::imu::RANGES;
use vrduino::sensor::RawSample;

/// How many samples an image takes of each kind: a rest is noticed in the 1500th.
pub const SAMPLES: u32 = 4000;

/// A motion, with a compass or without.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// A level board that turns about the vertical at up to 300 °/s, with noise.
    Head,
    /// A board that lies still, with noise and a bias.
    Still,
    /// The first again, with a field in every ninth sample: it meets each step of a block.
    HeadWithCompass,
    /// Anything the registers can hold, each end and zero more often than by chance; flips and falls among it.
    Anything,
    /// And any field.
    AnythingWithCompass,
}

impl Motion {
    /// Every one.
    pub const ALL: [Self; 5] = [
        Self::Head,
        Self::Still,
        Self::HeadWithCompass,
        Self::Anything,
        Self::AnythingWithCompass,
    ];

    /// Whether it is one that a head makes.
    pub fn is_usual(self) -> bool {
        !matches!(self, Self::Anything | Self::AnythingWithCompass)
    }

    /// The filter at its start, at 1 kHz and the board's ranges.
    pub fn filter<M: Multiply>() -> Fusion<M> {
        Fusion::with(
            &Parameters::default(),
            Rates {
                sample: Nanoseconds(1_000_000),
                field: Nanoseconds(10_000_000),
                ranges: RANGES,
            },
        )
    }

    /// Its sample of this number; `random` goes from one to the next.
    pub fn sample(self, number: u32, random: &mut Random) -> (RawSample, Option<Field>) {
        let (gyro, accel) = match self {
            Self::Head | Self::HeadWithCompass => {
                // There and back, at 1.25 Hz.
                let phase = (number % 800) as i16;
                let turn = (phase - 400).abs() * 24 - 4800;
                let gyro = [0, turn, 0].map(|counts| counts + random.noise(8));
                (gyro, [0, 2048, 0].map(|counts| counts + random.noise(300)))
            }
            Self::Still => {
                let gyro = [7, -11, 3].map(|counts| counts + random.noise(3));
                (
                    gyro,
                    [90, 2040, -70].map(|counts| counts + random.noise(12)),
                )
            }
            Self::Anything | Self::AnythingWithCompass => (
                [(); 3].map(|()| random.counts()),
                [(); 3].map(|()| random.counts()),
            ),
        };
        let sample = RawSample {
            gyro,
            accel,
            temperature: 0,
            fresh: true,
        };
        (sample, self.field(number, random))
    }

    fn field(self, number: u32, random: &mut Random) -> Option<Field> {
        let microtesla = match self {
            Self::HeadWithCompass if number.is_multiple_of(9) => {
                [0, -40, -20].map(|field| field + i32::from(random.noise(2)))
            }
            Self::AnythingWithCompass => [(); 3].map(|()| i32::from(random.counts())),
            _ => return None,
        };
        Some(Field::from_parts_of_microtesla(
            microtesla.map(|part| part << 15),
        ))
    }

    /// What is told the filter before this sample, so that no path is left out: a reset, a gap.
    pub fn prepare<M: Multiply>(self, number: u32, filter: &mut Fusion<M>, sample: &RawSample) {
        if self.is_usual() {
            return;
        }
        let force = Force::from_counts(sample.accel);
        match number % 1000 {
            300 => filter.level(force),
            600 => filter.reset(force),
            _ => {}
        }
    }
}
