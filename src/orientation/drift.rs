//! Drift corrected in tilt and yaw at once (the blog post “Headset Tracking for VR/AR”): the gyro's
//! step, then a share of the whole error that accelerometer and magnetometer show.
//!
//! Three places follow the post in what it means, not in what it prints:
//!
//! * Its gyro step Δq q turns about the axes of the world. A gyro fixed to the body turns about
//!   the body's: q Δq, as in eq. 18 of the notes.
//! * “Order does not matter” between the errors of tilt and yaw: it does, as with any two turns
//!   about different axes. Tilt is taken out first, and the magnetometer is read in a level frame.
//! * Its tilt axis ŷ × u turns ŷ into u, not u towards ŷ. That is right for an error, which its
//!   −α then takes back.
//!
//! The post's calibration Aω + b comes before: [`Reading::calibrated`]. The field wants the same, by
//! [`Calibration::corrected`](crate::sensor::measurement::Calibration::corrected).

use super::quaternion::{axis_angle, from_axis_angle};
use super::rotation::renormalised;
use super::{gyro, tilt, yaw};
use crate::calibration::Reading;
use crate::units::{Angle, MagneticField, Seconds, SpecificForce};
use nalgebra::{RealField, UnitQuaternion};

/// The post's filter: its q̃_k, d and q̃′_k. The post has no equation numbers.
///
/// ```
/// use vrduino::calibration::GyroBias;
/// use vrduino::nalgebra::{UnitQuaternion, Vector3};
/// use vrduino::orientation::drift::DriftCorrection;
/// use vrduino::sensor::Sample;
/// use vrduino::units::{AngularRate, MagneticField, Seconds, SpecificForce};
///
/// let mut filter = DriftCorrection::new(0.01, Seconds(0.01));
/// // The gyro says that nothing turns, and the start is 40° off in heading.
/// filter.set(UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.7));
/// let (rate, force) = (AngularRate::zero(), SpecificForce::from_g(Vector3::y()));
/// let reading = GyroBias::zero().correct(Sample { rate, force });
/// // Facing north, with the field dipping below it.
/// let field = MagneticField::from_microtesla(Vector3::new(0.0, -40.0, -20.0));
/// for _ in 0..1000 {
///     // None in place of the field wherever the magnetometer has nothing new.
///     filter.update(&reading, Some(field));
/// }
/// assert!(filter.orientation().angle() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct DriftCorrection<T: RealField> {
    sample_period: Seconds<T>,
    /// α of the post, 1 − α of the notes.
    gain: T,
    orientation: UnitQuaternion<T>,
}

impl<T: RealField + Copy> DriftCorrection<T> {
    /// Starts from the identity. `gain` is the post's α, the share of the error that one sample
    /// takes out, from 0 (the gyro alone) to 1; outside of that the nearer end, and 0 if it is
    /// not a number. For a time constant it is
    /// [`accelerometer_weight`](super::TimeConstant::accelerometer_weight).
    pub fn new(gain: T, sample_period: Seconds<T>) -> Self {
        let gain = if gain > T::zero() {
            gain.min(T::one())
        } else {
            T::zero()
        };
        Self {
            sample_period,
            gain,
            orientation: UnitQuaternion::identity(),
        }
    }

    /// One sample: q_k = q_{k−1} Δq, then q′_k = q(v, −αθ) q_k, where θ about v is the error d of
    /// [`error`].
    ///
    /// `field` is in the body frame, None where there is no magnetometer or nothing new from it
    /// since the last sample: then yaw is left alone, as the post's identity for d_yaw does. So is
    /// all that [`error`] cannot tell; a rate that is not finite turns nothing.
    pub fn update(
        &mut self,
        reading: &Reading<T>,
        field: Option<MagneticField<T>>,
    ) -> UnitQuaternion<T> {
        let q_k = renormalised(self.orientation * gyro::step(reading.rate(), self.sample_period));
        self.orientation = correct(q_k, error(q_k, reading.force(), field), self.gain);
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
}

/// The post's d = d_tilt d_yaw: how far an estimate is turned from the truth, d times the truth
/// being the estimate.
///
/// `estimate` is body to world; `force` and `field` are in the body frame. Without a field, or
/// where [`yaw::error`] has nothing to say, d_yaw is the identity. A force that has no direction
/// makes all of d the identity: with the tilt unknown, the dip of the field would pass for yaw.
pub fn error<T: RealField + Copy>(
    estimate: UnitQuaternion<T>,
    force: SpecificForce<T>,
    field: Option<MagneticField<T>>,
) -> UnitQuaternion<T> {
    let u = tilt::in_world(estimate, force);
    if !tilt::has_direction(u) {
        return UnitQuaternion::identity();
    }
    let to_level = tilt::correction(u, T::one());
    let level = renormalised(to_level * estimate);
    let d_yaw = field
        .and_then(|field| yaw::error(MagneticField::from_microtesla(level * field.microtesla())))
        .map_or_else(UnitQuaternion::identity, yaw::about_vertical);
    renormalised(to_level.inverse() * d_yaw)
}

/// q′ = q(v, −αθ) q for an error of θ about v, the short way round. `gain` is α; `estimate` and what
/// comes back are body to world, `error` is a turn in the world. A gain that is not finite corrects
/// nothing.
pub fn correct<T: RealField + Copy>(
    estimate: UnitQuaternion<T>,
    error: UnitQuaternion<T>,
    gain: T,
) -> UnitQuaternion<T> {
    let d = axis_angle(error);
    let back = Angle::from_rad(-gain * d.angle.rad());
    let back = from_axis_angle(d.axis.into_inner(), back).unwrap_or_else(UnitQuaternion::identity);
    renormalised(back * estimate)
}
