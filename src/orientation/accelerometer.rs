//! The whole orientation from the accelerometer alone (course notes, section 5.2, and figure 7 on
//! the left): as quick as a sample, without drift, and without yaw. Every acceleration of the head
//! shows as a tilt.

use super::tilt;
use crate::units::SpecificForce;
use nalgebra::{RealField, UnitQuaternion};

/// The shortest turn that takes the force (body frame) to up, q_a⁽ᵇᵒᵈʸ⁾ to q_up⁽ʷᵒʳˡᵈ⁾: body to
/// world. Its axis is horizontal, so it has no yaw, whatever the board's is.
///
/// Upside down every horizontal axis is as short, and x is taken. None in free fall and for a
/// force that is not finite, which have no up.
pub fn orientation<T: RealField + Copy>(force: SpecificForce<T>) -> Option<UnitQuaternion<T>> {
    tilt::has_direction(force).then(|| tilt::correction(force, T::one()))
}
