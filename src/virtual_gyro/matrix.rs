//! Second method: the rotation matrix M of eq. 7 (section 4.1), reference to device, in both ways
//! the paper derives it.
//!
//! Its columns are north, east and down as the device sees them. The two ways differ in which
//! sensor is believed: [`from_gravity`] has gravity exactly vertical, [`from_field`] has the
//! magnetic field exactly at its dip. They agree as far as the measured dip is the given one.

use super::fields::Directions;
use crate::units::Angle;
use nalgebra::{Matrix3, RealField, Rotation3, Vector3};

/// From T_gd = g_dN × C_dN, C_dN and g_dN. Needs no dip.
pub fn from_gravity<T: RealField + Copy>(directions: &Directions<T>) -> Rotation3<T> {
    let down = directions.gravity();
    let east = directions.east();
    // T_g points south.
    columns(-down.cross(&east), east, down)
}

/// From T_Bd = B_dN × C_dN, C_dN and B_dN, for a field that dips by `dip` (δ).
///
/// A wrong dip tilts the matrix by its error; [`Directions::dip`] has the measured one.
pub fn from_field<T: RealField + Copy>(directions: &Directions<T>, dip: Angle<T>) -> Rotation3<T> {
    let along = directions.magnetic();
    let east = directions.east();
    let across = along.cross(&east);
    let (sin, cos) = dip.rad().sin_cos();
    columns(along * cos - across * sin, east, along * sin + across * cos)
}

fn columns<T: RealField + Copy>(
    north: Vector3<T>,
    east: Vector3<T>,
    down: Vector3<T>,
) -> Rotation3<T> {
    Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[north, east, down]))
}
