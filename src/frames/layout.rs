//! The order in which a quaternion's four numbers are written. The course notes, lectures and the
//! serial line put the scalar first; the gyroscope-emulation paper puts it last, and so does
//! nalgebra's memory (`coords`), though not its constructor.
//!
//! Nothing is normalised here: four numbers of any length keep it.

use nalgebra::{Quaternion, RealField, Vector4};

/// From w, x, y, z: q_w to q_z of the course notes (eq. 25), q_0 to q_3 of the 2016 lecture.
pub fn from_scalar_first<T: RealField + Copy>([w, x, y, z]: [T; 4]) -> Quaternion<T> {
    Quaternion::new(w, x, y, z)
}

/// To w, x, y, z: q_w to q_z of the course notes (eq. 25), q_0 to q_3 of the 2016 lecture.
pub fn to_scalar_first<T: RealField + Copy>(q: Quaternion<T>) -> [T; 4] {
    [q.w, q.i, q.j, q.k]
}

/// From x, y, z, w: q_1 to q_4 of the paper (eq. 5).
pub fn from_scalar_last<T: RealField + Copy>(x_y_z_w: [T; 4]) -> Quaternion<T> {
    Quaternion::from_vector(Vector4::from(x_y_z_w))
}

/// To x, y, z, w: q_1 to q_4 of the paper (eq. 5).
pub fn to_scalar_last<T: RealField + Copy>(q: Quaternion<T>) -> [T; 4] {
    q.coords.into()
}
