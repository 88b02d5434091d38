//! Which of its six faces the board lies on, told by the force alone.

use crate::units::{Angle, METRES_PER_S2_PER_G};
use core::fmt;
use nalgebra::{RealField, Vector3, convert};

/// A position of the board: the axis of the body that points up or down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// x points up.
    XUp,
    /// x points down.
    XDown,
    /// y points up: the board as it is worn.
    YUp,
    /// y points down.
    YDown,
    /// z points up.
    ZUp,
    /// z points down.
    ZDown,
}

impl Face {
    /// All six; x, y, z, and of each first up.
    pub const ALL: [Self; 6] = [
        Self::XUp,
        Self::XDown,
        Self::YUp,
        Self::YDown,
        Self::ZUp,
        Self::ZDown,
    ];

    /// 0, 1 or 2 for x, y or z.
    pub const fn axis(self) -> usize {
        self as usize / 2
    }

    /// Whether the axis points up.
    pub const fn is_up(self) -> bool {
        (self as usize).is_multiple_of(2)
    }

    /// The face nearest to this force (body frame), and the angle to it. The angle is not a number if
    /// the force is zero or not finite.
    pub(super) fn nearest<T: RealField + Copy>(force: Vector3<T>) -> (Self, Angle<T>) {
        let axis = force.iamax();
        let up = force[axis] > T::zero();
        let face = Self::ALL[2 * axis + usize::from(!up)];
        let mut across = force;
        across[axis] = T::zero();
        // An arc cosine would lose the small angles.
        let angle = (across.norm() / force[axis].abs()).atan();
        (face, Angle::from_rad(angle))
    }

    /// What an accelerometer without fault reads on this face, m/s².
    pub(super) fn force<T: RealField + Copy>(self) -> Vector3<T> {
        let mut force = Vector3::zeros();
        let g: T = convert(METRES_PER_S2_PER_G);
        force[self.axis()] = if self.is_up() { g } else { -g };
        force
    }
}

impl fmt::Display for Face {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(["x up", "x down", "y up", "y down", "z up", "z down"][*self as usize])
    }
}

/// Some of the six faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faces(u8);

impl Faces {
    pub(super) fn insert(&mut self, face: Face) {
        self.0 |= 1 << face as u8;
    }

    /// Whether this one is among them.
    pub fn contains(self, face: Face) -> bool {
        self.0 & (1 << face as u8) != 0
    }

    /// Whether there is none.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// One after the other.
    pub fn iter(self) -> impl Iterator<Item = Face> {
        Face::ALL
            .into_iter()
            .filter(move |&face| self.contains(face))
    }
}

impl fmt::Display for Faces {
    /// “x up, z down”.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, face) in self.iter().enumerate() {
            write!(f, "{}{face}", if index == 0 { "" } else { ", " })?;
        }
        Ok(())
    }
}
