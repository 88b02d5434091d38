//! The side a step is multiplied on. A gyro is fixed to the body, so its step is about the body's
//! axes and stands on the right: q q_Δ (course notes eq. 18). A step about the world's axes, like
//! the tilt correction, stands on the left (eq. 24). The blog post multiplies the gyro's step from
//! the left, which is a turn about other axes; it would be right for the step in world axes.
//!
//! A quaternion that is zero or not finite counts as the identity.

use crate::orientation::quaternion::trued;
use nalgebra::{RealField, UnitQuaternion};

/// The step about the world's axes that does what `body_step` does to a body of this orientation
/// (body to world): Δ_world q = q Δ_body.
pub fn step_in_world<T: RealField + Copy>(
    orientation: UnitQuaternion<T>,
    body_step: UnitQuaternion<T>,
) -> UnitQuaternion<T> {
    let orientation = trued(orientation);
    trued(orientation * trued(body_step) * orientation.conjugate())
}

/// The step about the body's axes that does what `world_step` does to a body of this orientation
/// (body to world): q Δ_body = Δ_world q.
pub fn step_in_body<T: RealField + Copy>(
    orientation: UnitQuaternion<T>,
    world_step: UnitQuaternion<T>,
) -> UnitQuaternion<T> {
    let orientation = trued(orientation);
    trued(orientation.conjugate() * trued(world_step) * orientation)
}
