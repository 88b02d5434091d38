//! What modes 1 and 2 show beside the fused orientation.

use super::estimators::SAMPLE_NANOSECONDS;
use super::{SAMPLE_PERIOD, unit};
use crate::calibration::GyroBias;
use crate::fixed::complementary::{Bias, Complementary, Force, Nanoseconds, Parameters};
use crate::fixed::multiply::Multiply;
use crate::orientation::DEFAULT_TIME_CONSTANT;
use crate::orientation::flatland::{Flatland, Roll};
use crate::sensor::{GyroRange, Ranges, Sample};
use crate::units::{AngularRate, SpecificForce};
use nalgebra::Vector3;

/// They run only while they are shown.
#[derive(Clone, Debug)]
pub struct Views<M> {
    range: GyroRange,
    flat: Flatland<f32>,
    /// Of which only the turns by the gyro are used: section 5.1 of the notes.
    gyro: Complementary<M>,
}

impl<M: Multiply> Views<M> {
    /// From the identity, for a sensor set to these ranges.
    pub fn new(ranges: Ranges) -> Self {
        Self {
            range: ranges.gyro,
            flat: Flatland::new(DEFAULT_TIME_CONSTANT, SAMPLE_PERIOD),
            gyro: Complementary::with(&Parameters {
                gyro: ranges.gyro,
                sample_period: SAMPLE_NANOSECONDS,
                time_constant: DEFAULT_TIME_CONSTANT,
            }),
        }
    }

    /// Both go on from this orientation, body to world, in units of 2⁻³⁰.
    pub fn restart(&mut self, orientation: [i32; 4]) {
        let up = unit(orientation).inverse() * Vector3::y();
        self.flat.reset(SpecificForce::from_g(up));
        self.gyro.set(orientation);
    }

    /// A sample in the plane (section 3), with its bias. A longer period than the nominal one turns further.
    pub fn update_flat(&mut self, sample: Sample<f32>, bias: GyroBias<f32>, period: Nanoseconds) {
        let longer = period.0 as f32 / SAMPLE_NANOSECONDS.0 as f32;
        let turn = (sample.rate.rad_per_s() - bias.rate().rad_per_s()) * longer;
        let rate = AngularRate::from_rad_per_s(turn);
        let stretched = Sample { rate, ..sample };
        self.flat.update(&GyroBias::zero().correct(stretched));
    }

    /// A sample for the gyro alone, with its bias.
    pub fn update_gyro(&mut self, gyro: [i16; 3], bias: GyroBias<f32>, period: Nanoseconds) {
        self.gyro.set_sample_period(period);
        self.gyro.set_bias(Bias::new(bias, self.range));
        self.gyro.update_corrected(gyro, Force::ZERO);
    }

    /// Roll three ways.
    pub fn roll(&self) -> Roll<f32> {
        self.flat.roll()
    }

    /// By the gyro alone, body to world, in units of 2⁻³⁰.
    pub fn gyro(&self) -> [i32; 4] {
        self.gyro.bits()
    }
}
