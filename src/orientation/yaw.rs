//! How far off north (the blog post's d_yaw): the field of the earth, rotated into the world,
//! ought to point to −z and down; how far its horizontal part is turned from −z is the error of
//! yaw.
//!
//! North is where a compass points, which by the local declination is not where the pole is. The
//! world of a filter corrected by it has −z to magnetic north.

use crate::units::{Angle, MagneticField};
use nalgebra::{RealField, Unit, UnitQuaternion, Vector3, convert};

/// A horizontal part below this share of the field has no direction worth the name: in the field
/// of the earth it is 0.5 nT, three hundred times less than the magnetometer can tell, and it is
/// what rounding leaves of a vertical field.
const VERTICAL: f64 = 1e-5;

/// ψ, from −π to π: the heading stands this far too far to the left (counter-clockwise from
/// above).
///
/// `field` is in the **world** frame as the estimate has it, with the tilt right: of a tilted
/// estimate a part of the vertical field would count as north. None if the field is vertical,
/// zero, or not finite: then nothing is known of yaw.
///
/// The post has ψ = cos⁻¹(−n·z/|n|), which loses the sign and contains the dip of the field: at a
/// dip of 60° it reads 60° with no error at all. Here n is projected to the horizontal plane and
/// ψ = atan2(−n_x, −n_z).
pub fn error<T: RealField + Copy>(field: MagneticField<T>) -> Option<Angle<T>> {
    let n = field.microtesla();
    let largest = n.amax();
    if largest.is_zero() || !n.iter().all(|component| component.is_finite()) {
        return None;
    }
    // The largest component becomes ±1, so that the squares neither overflow nor all vanish.
    let n = n / largest;
    let horizontal = (n.x * n.x + n.z * n.z).sqrt();
    let known = horizontal > n.norm() * convert(VERTICAL);
    known.then(|| Angle::from_rad((-n.x).atan2(-n.z)))
}

/// A turn about the vertical, as which ψ goes into the post's d.
pub(super) fn about_vertical<T: RealField + Copy>(psi: Angle<T>) -> UnitQuaternion<T> {
    let up: Unit<Vector3<T>> = Vector3::y_axis();
    UnitQuaternion::from_axis_angle(&up, psi.rad())
}
