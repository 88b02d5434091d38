//! Angular velocity (section 3.5.5), in the device frame and in the reference frame.
//!
//! For a quaternion device to reference, 2 q⁻¹ q̇ is in the **device** frame, which is what a
//! strapped gyro and figure 8 show, and 2 q̇ q⁻¹ in the reference frame. The paper has the first
//! formula under the second name, and a matrix that is neither.

use super::angles::TaitBryan;
use crate::units::{AngularRate, Seconds};
use nalgebra::{Quaternion, RealField, UnitQuaternion, Vector3, convert};

/// One angular velocity (section 3.5.5), seen from two frames, north-east-down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngularVelocity<T> {
    /// ω_d, about the device's axes.
    pub device: AngularRate<T>,
    /// ω_r, about north, east and down.
    pub reference: AngularRate<T>,
}

impl<T: RealField + Copy> AngularVelocity<T> {
    /// 2 q⁻¹ q̇ and 2 q̇ q⁻¹, for a q device to reference and its derivative (1/s). What is not finite
    /// stays so.
    pub fn from_derivative(q: &UnitQuaternion<T>, q_dot: &Quaternion<T>) -> Self {
        let inverse = q.conjugate().into_inner();
        let two: T = convert(2.0);
        Self {
            device: AngularRate::from_rad_per_s((inverse * *q_dot).imag() * two),
            reference: AngularRate::from_rad_per_s((*q_dot * inverse).imag() * two),
        }
    }

    /// From the rates of the three angles, in rad/s: (φ̇, θ̇, ψ̇). What is not finite stays so.
    pub fn from_angle_rates(angles: &TaitBryan<T>, rates: Vector3<T>) -> Self {
        let (sin_phi, cos_phi) = angles.roll.rad().sin_cos();
        let (sin_theta, cos_theta) = angles.pitch.rad().sin_cos();
        let (sin_psi, cos_psi) = angles.yaw.rad().sin_cos();
        let (phi, theta, psi) = (rates.x, rates.y, rates.z);
        Self {
            device: AngularRate::from_rad_per_s(Vector3::new(
                phi - sin_theta * psi,
                cos_phi * theta + sin_phi * cos_theta * psi,
                cos_phi * cos_theta * psi - sin_phi * theta,
            )),
            reference: AngularRate::from_rad_per_s(Vector3::new(
                cos_theta * cos_psi * phi - sin_psi * theta,
                cos_theta * sin_psi * phi + cos_psi * theta,
                psi - sin_theta * phi,
            )),
        }
    }

    /// The mean over the time between two attitudes, by the shortest turn: exact for a steady
    /// turn of less than half a revolution. None unless the time is positive and finite.
    ///
    /// A difference quotient for q̇ in 2 q⁻¹ q̇ falls short by the cube of the turn; the logarithm
    /// of q⁻¹(t) q(t + Δt) does not.
    pub fn between(
        earlier: &UnitQuaternion<T>,
        later: &UnitQuaternion<T>,
        time: Seconds<T>,
    ) -> Option<Self> {
        let rate = |turn: UnitQuaternion<T>| {
            let rad_per_s = rotation_vector(&turn) / time.0;
            let finite = rad_per_s.iter().all(|component| component.is_finite());
            finite.then(|| AngularRate::from_rad_per_s(rad_per_s))
        };
        if !(time.0 > T::zero() && time.0.is_finite()) {
            return None;
        }
        let later = nearer(earlier, later);
        Some(Self {
            device: rate(earlier.inverse() * later)?,
            reference: rate(later * earlier.inverse())?,
        })
    }
}

/// q or −q, which are the same attitude: whichever is nearer to the one before. Without it a
/// change of sign, as between two cases of table 2, would look like a full turn.
pub fn nearer<T: RealField + Copy>(
    before: &UnitQuaternion<T>,
    q: &UnitQuaternion<T>,
) -> UnitQuaternion<T> {
    if before.coords.dot(&q.coords) < T::zero() {
        UnitQuaternion::new_unchecked(-q.into_inner())
    } else {
        *q
    }
}

/// Twice the logarithm: the axis times the angle.
fn rotation_vector<T: RealField + Copy>(q: &UnitQuaternion<T>) -> Vector3<T> {
    let (axis, sine) = (q.imag(), q.imag().norm());
    let two: T = convert(2.0);
    if sine.is_zero() {
        return axis * two;
    }
    axis * (two * sine.atan2(q.w) / sine)
}
