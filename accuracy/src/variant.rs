//! What becomes of accuracy when the sensor is worse than the recorder's, or nobody waits for it.

use nalgebra::Vector3;
use vrduino::imu::RANGES;
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, MagneticField, SpecificForce};

use crate::trial::{NineAxes, Trial};

/// How a recording is changed before it is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Not at all: the file's counts, which are scaled to the peak of each file.
    AsRecorded,
    /// What the registers of our sensor would hold: ±2000 °/s, ±16 g, 0.15 µT a count.
    Registers,
    /// The mean of three samples at a third of the rate: 95 Hz for BROAD.
    ThirdOfTheRate,
    /// The mean of six at a sixth: 48 Hz.
    SixthOfTheRate,
    /// A gyro that reads 1 °/s more on every axis; it still begins at rest.
    Biased,
    /// The same, cut one second before the first motion.
    ColdStart,
}

/// 1 °/s in rad/s.
const BIAS: f64 = std::f64::consts::PI / 180.0;
/// Of the AK8963 with 16 bits, µT.
const MAGNETOMETER_COUNT: f64 = 0.15;
/// s of rest that a cold start leaves.
const COLD: f64 = 1.0;

impl Variant {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::AsRecorded,
        Self::Registers,
        Self::ThirdOfTheRate,
        Self::SixthOfTheRate,
        Self::Biased,
        Self::ColdStart,
    ];

    /// A heading for a column.
    pub fn heading(self) -> &'static str {
        match self {
            Self::AsRecorded => "recorded",
            Self::Registers => "registers",
            Self::ThirdOfTheRate => "1/3 rate",
            Self::SixthOfTheRate => "1/6 rate",
            Self::Biased => "+1 °/s",
            Self::ColdStart => "cold",
        }
    }

    /// The changed recording.
    pub fn of(self, trial: &Trial) -> Trial {
        match self {
            Self::AsRecorded => trial.clone(),
            Self::Registers => with_samples(trial, |axes| NineAxes {
                sample: RANGES.sample(&RANGES.counts(&axes.sample)),
                field: MagneticField::from_microtesla(
                    axes.field
                        .microtesla()
                        .map(|field| (field / MAGNETOMETER_COUNT).round() * MAGNETOMETER_COUNT),
                ),
            }),
            Self::ThirdOfTheRate => block_means(trial, 3),
            Self::SixthOfTheRate => block_means(trial, 6),
            Self::Biased => with_samples(trial, biased),
            Self::ColdStart => {
                let rest = (COLD / trial.period) as usize;
                let from = trial.first_motion().unwrap_or(0).saturating_sub(rest);
                let cut = Trial {
                    samples: trial.samples[from..].to_vec(),
                    reference: trial.reference[from..].to_vec(),
                    scored: trial.scored[from..].to_vec(),
                    ..trial.clone()
                };
                with_samples(&cut, biased)
            }
        }
    }
}

fn with_samples(trial: &Trial, change: impl Fn(&NineAxes) -> NineAxes) -> Trial {
    Trial {
        samples: trial.samples.iter().map(change).collect(),
        ..trial.clone()
    }
}

fn biased(axes: &NineAxes) -> NineAxes {
    let rate = axes.sample.rate.rad_per_s().add_scalar(BIAS);
    NineAxes {
        sample: Sample {
            rate: AngularRate::from_rad_per_s(rate),
            ..axes.sample
        },
        ..*axes
    }
}

/// Each block becomes one sample, at the time of its last.
fn block_means(trial: &Trial, size: usize) -> Trial {
    let mean = |block: &[NineAxes], part: fn(&NineAxes) -> Vector3<f64>| {
        block.iter().map(part).sum::<Vector3<f64>>() / size as f64
    };
    let samples = trial.samples.chunks_exact(size).map(|block| NineAxes {
        sample: Sample {
            rate: AngularRate::from_rad_per_s(mean(block, |axes| axes.sample.rate.rad_per_s())),
            force: SpecificForce::from_m_per_s2(mean(block, |axes| axes.sample.force.m_per_s2())),
        },
        field: MagneticField::from_microtesla(mean(block, |axes| axes.field.microtesla())),
    });
    Trial {
        name: trial.name.clone(),
        period: trial.period * size as f64,
        samples: samples.collect(),
        reference: lasts(&trial.reference, size),
        scored: lasts(&trial.scored, size),
    }
}

fn lasts<T: Copy>(values: &[T], size: usize) -> Vec<T> {
    let blocks = values.chunks_exact(size);
    blocks.map(|block| block[size - 1]).collect()
}
