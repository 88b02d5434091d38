//! All three calibrations as they are applied, sample by sample.

use super::ellipsoid::Magnetometer;
use super::six_positions::Accelerometer;
use super::{GyroBias, Reading};
use crate::sensor::Sample;
use crate::sensor::measurement::Calibration;
use crate::units::{MagneticField, SpecificForce};
use nalgebra::{Matrix3, RealField, Vector3};

/// What is known of a sensor's faults. What is not known is left as the sensor reports it.
///
/// Everything is in the body frame, fields included: they have gone through
/// [`to_body`](crate::sensor::magnetometer::to_body) first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction<T: RealField + Copy> {
    /// Of the gyro.
    pub gyro: GyroBias<T>,
    /// Of the accelerometer.
    pub accelerometer: Calibration<SpecificForce<T>>,
    /// Of the magnetometer.
    pub magnetometer: Calibration<MagneticField<T>>,
}

impl<T: RealField + Copy> Correction<T> {
    /// For sensors without fault, or of which nothing is known.
    pub fn none() -> Self {
        let (matrix, zero) = (Matrix3::identity(), Vector3::zeros());
        Self {
            gyro: GyroBias::zero(),
            accelerometer: Calibration::new(matrix, SpecificForce::from_m_per_s2(zero)),
            magnetometer: Calibration::new(matrix, MagneticField::from_microtesla(zero)),
        }
    }

    /// The same with another gyro bias: it changes most, and is measured at every start.
    pub fn with_gyro(self, gyro: GyroBias<T>) -> Self {
        Self { gyro, ..self }
    }

    /// The same with the result of six positions.
    pub fn with_accelerometer(self, result: &Accelerometer<T>) -> Self {
        Self {
            accelerometer: result.calibration(),
            ..self
        }
    }

    /// The same with the result of an ellipsoid fit.
    pub fn with_magnetometer(self, result: &Magnetometer<T>) -> Self {
        Self {
            magnetometer: result.calibration(),
            ..self
        }
    }

    /// The sample with its force corrected and the gyro's bias still in it: for an estimator that
    /// keeps the bias up itself, such as [`Fusion`](crate::fusion::Fusion).
    pub fn sample(&self, sample: Sample<T>) -> Sample<T> {
        Sample {
            force: self.accelerometer.corrected(sample.force),
            ..sample
        }
    }

    /// The sample with rate and force corrected.
    pub fn correct(&self, sample: Sample<T>) -> Reading<T> {
        self.gyro.correct(self.sample(sample))
    }

    /// The field corrected.
    pub fn field(&self, field: MagneticField<T>) -> MagneticField<T> {
        self.magnetometer.corrected(field)
    }
}
