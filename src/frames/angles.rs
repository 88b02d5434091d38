//! Yaw, pitch and roll by their two definitions, and an angle by its two ranges.
//!
//! The gyroscope-emulation paper's angles (section 3.1) are about z, down, then the new y, to the
//! right, then the new x, ahead; the course notes' (section 4) about y, up, then the new x, to the
//! right, then the new z, backwards.

use crate::orientation::euler::EulerAngles;
use crate::units::Angle;
use crate::virtual_gyro::angles::TaitBryan;
use nalgebra::RealField;

impl<T: RealField + Copy> TaitBryan<T> {
    /// The same orientation in the notes' angles: the paper's section 3.1, in north-east-down, to
    /// eq. 10 of the notes, y up ([`Axes::orientation_to_y_up`](super::axes::Axes)). The order is
    /// the same, and so is the axis of pitch; those of yaw and roll are opposite. What is not finite
    /// stays so.
    pub fn to_notes(self) -> EulerAngles<T> {
        EulerAngles {
            yaw: negated(self.yaw),
            pitch: self.pitch,
            roll: negated(self.roll),
        }
    }
}

impl<T: RealField + Copy> EulerAngles<T> {
    /// The same orientation in the paper's angles (section 3.1): the inverse of
    /// [`TaitBryan::to_notes`].
    pub fn to_paper(self) -> TaitBryan<T> {
        TaitBryan {
            roll: negated(self.roll),
            pitch: self.pitch,
            yaw: negated(self.yaw),
        }
    }
}

fn negated<T: RealField + Copy>(angle: Angle<T>) -> Angle<T> {
    Angle::from_rad(-angle.rad())
}

/// The same angle from 0 up to a whole turn, the blog post's 0 ≤ θ ≤ 2π. None if it is not finite.
pub fn whole_turn<T: RealField + Copy>(angle: Angle<T>) -> Option<Angle<T>> {
    let angle = short_way(angle)?.rad();
    Some(Angle::from_rad(if angle < T::zero() {
        angle + T::two_pi()
    } else {
        angle
    }))
}

/// The same angle between half a turn one way and half a turn the other, what is to be corrected
/// by a fraction (course notes eq. 9 and 24, the blog post's −αθ). None if it is not finite.
pub fn short_way<T: RealField + Copy>(angle: Angle<T>) -> Option<Angle<T>> {
    let angle = angle.rad();
    if !angle.is_finite() {
        return None;
    }
    // The remainder is exact, however many turns there were, and has the sign of the angle.
    let rest = angle % T::two_pi();
    Some(Angle::from_rad(if rest > T::pi() {
        rest - T::two_pi()
    } else if rest < -T::pi() {
        rest + T::two_pi()
    } else {
        rest
    }))
}
