//! Where drift comes from, and how much of it (course notes, sections 3.1 and 3.3).
//!
//! The notes and the lectures put it down to the integration error mostly. It is the other way
//! round: the error of a step is of the order of Δt², as they say, but in a sum of steps nearly
//! everything cancels, and what is left is bounded. A bias left in the readings is not. All rates
//! are about z, the axis flatland turns about, and all errors are estimate minus truth. What is not
//! finite makes an error that is not.

use crate::orientation::TimeConstant;
use crate::units::{Angle, AngularRate, Seconds};
use nalgebra::{RealField, convert};

/// Of eq. 7 after `time`, from a bias left in the readings: b T, without bound.
pub fn gyro_drift<T: RealField + Copy>(bias: AngularRate<T>, time: Seconds<T>) -> Angle<T> {
    Angle::from_rad(bias.rad_per_s().z * time.0)
}

/// Of eq. 9 in the long run, from a bias left in the readings: α Δt b/(1 − α) = τ b.
///
/// “No drift” is not “no error”: the angle stands still, but off by this. None where it never
/// stands still, as with the gyro alone (α = 1), and for a bias that is not finite.
pub fn fused_offset<T: RealField + Copy>(
    bias: AngularRate<T>,
    time_constant: TimeConstant<T>,
) -> Option<Angle<T>> {
    let offset = bias.rad_per_s().z * time_constant.time().0;
    offset.is_finite().then(|| Angle::from_rad(offset))
}

/// Of eq. 6 from step to step, with a perfect gyro: −Δt/2 (ω(T) − ω(0)) and terms of Δt² (Euler and
/// Maclaurin), for a motion that is smooth at this step. It depends on how fast the motion is at its
/// ends and not on how long it lasts.
///
/// Eq. 6 takes the rate at the beginning of a step. With the rate at its end the sign is the
/// opposite.
pub fn integration_error<T: RealField + Copy>(
    first: AngularRate<T>,
    last: AngularRate<T>,
    step: Seconds<T>,
) -> Angle<T> {
    let change = last.rad_per_s().z - first.rad_per_s().z;
    Angle::from_rad(-change * step.0 * convert(0.5))
}
