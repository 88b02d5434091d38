//! Eq. 1 to 5 as a generator: from what a body does to what a sensor with faults would report.
//! The same seed gives the same readings, so a test that uses it can be repeated.

use super::measurement::{MeasurementModel, Triaxial};
use super::{Ranges, RawSample, Sample};
use crate::units::{AngularRate, SpecificForce};
use nalgebra::{ComplexField, RealField, Vector3, convert};

/// η ~ N(0, 1) of eq. 1 and 2: independent numbers with a normal distribution.
#[derive(Clone, Debug)]
pub struct Gaussian {
    state: u64,
    /// The transform makes two numbers at a time.
    second: Option<f64>,
}

impl Gaussian {
    /// Every seed is the start of another sequence.
    pub fn new(seed: u64) -> Self {
        Self {
            state: seed,
            second: None,
        }
    }

    /// The next number, mean 0 and standard deviation 1 (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        if let Some(second) = self.second.take() {
            return second;
        }
        // In (0, 1], so that its logarithm is finite.
        let radius = ComplexField::sqrt(-2.0 * ComplexField::ln(1.0 - self.uniform()));
        let (sin, cos) = ComplexField::sin_cos(core::f64::consts::TAU * self.uniform());
        self.second = Some(radius * sin);
        radius * cos
    }

    /// Three of them, one per axis.
    pub fn triple<T: RealField + Copy>(&mut self) -> Vector3<T> {
        Vector3::from_fn(|_, _| convert(self.normal()))
    }

    /// In [0, 1), 53 bits (SplitMix64, Steele et al. 2014).
    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Three axes of one kind, with their faults and their noise: eq. 1, 2, 3 or 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulatedTriad<Q: Triaxial> {
    model: MeasurementModel<Q>,
    deviation: Q,
}

impl<Q: Triaxial> SimulatedTriad<Q> {
    /// `deviation` is σ of eq. 1 or 2, per axis.
    pub fn new(model: MeasurementModel<Q>, deviation: Q) -> Self {
        Self { model, deviation }
    }

    /// One measurement of `truth`, body frame.
    pub fn measure(&self, truth: Q, noise: &mut Gaussian) -> Q {
        let eta = noise.triple().component_mul(&self.deviation.components());
        self.model.measured(truth, Q::from_components(eta))
    }
}

/// Gyro and accelerometer with their converters: eq. 1 to 4, and eq. 5 the other way.
#[derive(Clone, Debug)]
pub struct SimulatedImu<T: RealField + Copy> {
    gyro: SimulatedTriad<AngularRate<T>>,
    accelerometer: SimulatedTriad<SpecificForce<T>>,
    ranges: Ranges,
    noise: Gaussian,
}

impl<T: RealField + Copy> SimulatedImu<T> {
    /// A sensor set to `ranges`.
    pub fn new(
        gyro: SimulatedTriad<AngularRate<T>>,
        accelerometer: SimulatedTriad<SpecificForce<T>>,
        ranges: Ranges,
        seed: u64,
    ) -> Self {
        Self {
            gyro,
            accelerometer,
            ranges,
            noise: Gaussian::new(seed),
        }
    }

    /// What the sensor measures before it is put into counts. Body frame; for `force` see
    /// [`super::measurement::specific_force`].
    pub fn measure(&mut self, rate: AngularRate<T>, force: SpecificForce<T>) -> Sample<T> {
        Sample {
            rate: self.gyro.measure(rate, &mut self.noise),
            force: self.accelerometer.measure(force, &mut self.noise),
        }
    }

    /// The same in counts, rounded and clipped.
    pub fn sample(&mut self, rate: AngularRate<T>, force: SpecificForce<T>) -> RawSample {
        let sample = self.measure(rate, force);
        self.ranges.counts(&sample)
    }
}
