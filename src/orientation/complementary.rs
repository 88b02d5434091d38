//! The filter that is streamed (course notes, section 5.3): dead reckoning, and after each step a
//! small turn towards level. Errors of the gyro slower than the time constant are taken out in
//! pitch and roll; forces quicker than it are averaged away. Yaw drifts by what is left of the
//! gyro's bias, since neither sensor knows where north is.

use super::rotation::renormalised;
use super::{TimeConstant, gyro, tilt};
use crate::calibration::Reading;
use crate::units::{Seconds, SpecificForce};
use nalgebra::{RealField, UnitQuaternion};

/// The complementary filter on quaternions, eq. 24.
///
/// ```
/// use vrduino::calibration::GyroBias;
/// use vrduino::nalgebra::Vector3;
/// use vrduino::orientation::{DEFAULT_TIME_CONSTANT, complementary::Complementary};
/// use vrduino::sensor::Sample;
/// use vrduino::units::{AngularRate, Seconds, SpecificForce};
///
/// let bias = GyroBias::new(AngularRate::from_dps(Vector3::new(0.8, -0.5, 0.3)));
/// let mut filter = Complementary::new(DEFAULT_TIME_CONSTANT, Seconds(0.001));
/// filter.reset(SpecificForce::from_g(Vector3::y()));
/// // A second of 90 °/s to the left, about the vertical.
/// for _ in 0..1000 {
///     let rate = AngularRate::from_dps(Vector3::new(0.8, 89.5, 0.3));
///     let force = SpecificForce::from_g(Vector3::y());
///     filter.update(&bias.correct(Sample { rate, force }));
/// }
/// let ahead = filter.orientation() * -Vector3::z();
/// assert!((ahead + Vector3::x()).norm() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Complementary<T: RealField> {
    derived: Derived<T>,
    orientation: UnitQuaternion<T>,
}

/// What follows from the time constant and the sample period.
#[derive(Clone, Copy, Debug)]
struct Derived<T> {
    sample_period: Seconds<T>,
    /// 1 − α of eq. 24.
    accelerometer_weight: T,
}

impl<T: RealField + Copy> Complementary<T> {
    /// Starts from the identity, as the notes do (section 5.1): a board that is not level is taken for
    /// one that is, and needs some time constants to be found out. [`reset`](Self::reset) with the
    /// first force levels it at once.
    pub fn new(time_constant: TimeConstant<T>, sample_period: Seconds<T>) -> Self {
        Self {
            derived: Derived {
                sample_period,
                accelerometer_weight: time_constant.accelerometer_weight(sample_period),
            },
            orientation: UnitQuaternion::identity(),
        }
    }

    /// One sample. Eq. 24: q ← q((1 − α)φ, n/|n|) q_ω with q_ω = q q_Δ (eq. 18).
    ///
    /// The tilt is that of q_ω, after the gyro's step: correcting one orientation by the tilt of
    /// another would leave a whole step behind. The correction stands on the left, because its
    /// axis is in the world. A rate that is not finite turns nothing, and a force that has no
    /// direction (free fall, or not finite) corrects nothing.
    pub fn update(&mut self, reading: &Reading<T>) -> UnitQuaternion<T> {
        let Derived {
            sample_period,
            accelerometer_weight,
        } = self.derived;
        let q_omega = self.orientation * gyro::step(reading.rate(), sample_period);
        let up = tilt::in_world(q_omega, reading.force());
        let q_t = tilt::correction(up, accelerometer_weight);
        self.orientation = renormalised(q_t * q_omega);
        self.orientation
    }

    /// As of the last sample, body to world.
    pub fn orientation(&self) -> UnitQuaternion<T> {
        self.orientation
    }

    /// Starts again from this orientation, body to world; from the identity if it is zero or not
    /// finite.
    pub fn set(&mut self, orientation: UnitQuaternion<T>) {
        self.orientation = renormalised(orientation);
    }

    /// Starts again with no turn about the vertical and the tilt this force (body frame) shows
    /// (section 5.2); from the identity if it shows none.
    pub fn reset(&mut self, force: SpecificForce<T>) {
        self.set(tilt::level(UnitQuaternion::identity(), force));
    }

    /// Takes the tilt this force (body frame) shows at once and keeps yaw: for after a gap, when
    /// the time constant is too long to wait for. A force without direction changes nothing.
    pub fn level(&mut self, force: SpecificForce<T>) {
        self.set(tilt::level(self.orientation, force));
    }
}
