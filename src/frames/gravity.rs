//! An accelerometer at rest reads the force that holds it up; the gyroscope-emulation paper wants
//! the pull that it holds against. They are opposite: g_d = −(accelerometer).

use crate::units::SpecificForce;
use nalgebra::{RealField, Vector3};

/// The pull of the earth as an acceleration, g_d of the paper (section 3.1, eq. 2), in m/s². It
/// points **down**, in whatever axes the force it comes from has: see [`super::axes`] for those.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity<T>(Vector3<T>);

impl<T: RealField + Copy> Gravity<T> {
    /// What a resting accelerometer (course notes eq. 2 without a⁽ˡ⁾) tells of gravity.
    pub fn from_accelerometer(force: SpecificForce<T>) -> Self {
        Self(-force.m_per_s2())
    }

    /// What a resting accelerometer reads under this pull.
    pub fn accelerometer(self) -> SpecificForce<T> {
        SpecificForce::from_m_per_s2(-self.0)
    }

    /// From metres per second squared. (The paper's section 3.1 says Newtons, of an acceleration.)
    pub fn from_m_per_s2(m_per_s2: Vector3<T>) -> Self {
        Self(m_per_s2)
    }

    /// In metres per second squared.
    pub fn m_per_s2(self) -> Vector3<T> {
        self.0
    }
}
