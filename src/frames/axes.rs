//! The axes a vector's components belong to.

use nalgebra::{Quaternion, RealField, UnitQuaternion, Vector3};

/// The right-handed frames of the documents. Each names a frame of the world, and with it that of
/// a body lying level and facing north: the two coincide at the identity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// x right (east), y up, −z ahead (north): the course notes, the lectures, the text of the blog
    /// post, OpenGL, and everything else in this crate.
    YUp,
    /// x north, y east, z down: the gyroscope-emulation paper, section 3.1, and aviation.
    NorthEastDown,
    /// x east, y north, z up: no document here, but maps, ROS, and most recorded motions.
    EastNorthUp,
    /// The axes as the blog post's picture shows them, which its text renames: z to y, x to z,
    /// y to x.
    Picture,
}

impl Axes {
    /// A vector with components along these axes, along those of [`Axes::YUp`]. Components are
    /// exchanged and negated and otherwise untouched.
    pub fn to_y_up<T: RealField + Copy>(self, v: Vector3<T>) -> Vector3<T> {
        match self {
            Self::YUp => v,
            Self::NorthEastDown => Vector3::new(v.y, -v.z, -v.x),
            Self::EastNorthUp => Vector3::new(v.x, v.z, -v.y),
            Self::Picture => Vector3::new(v.y, v.z, v.x),
        }
    }

    /// A vector with components along those of [`Axes::YUp`], along these axes.
    pub fn from_y_up<T: RealField + Copy>(self, v: Vector3<T>) -> Vector3<T> {
        match self {
            Self::YUp => v,
            Self::NorthEastDown => Vector3::new(-v.z, v.x, -v.y),
            Self::EastNorthUp => Vector3::new(v.x, -v.z, v.y),
            Self::Picture => Vector3::new(v.z, v.x, v.y),
        }
    }

    /// An orientation, body to world, of a body and a world that both have these axes, for a body
    /// and a world that both have [`Axes::YUp`]. The angle stays; the axis is a vector like others.
    /// Components are exchanged and negated, so what is not of unit length is not afterwards.
    pub fn orientation_to_y_up<T: RealField + Copy>(
        self,
        q: UnitQuaternion<T>,
    ) -> UnitQuaternion<T> {
        with_axis(q, self.to_y_up(q.imag()))
    }

    /// The inverse of [`Axes::orientation_to_y_up`].
    pub fn orientation_from_y_up<T: RealField + Copy>(
        self,
        q: UnitQuaternion<T>,
    ) -> UnitQuaternion<T> {
        with_axis(q, self.from_y_up(q.imag()))
    }
}

/// The same scalar and another vector of the same length.
fn with_axis<T: RealField + Copy>(q: UnitQuaternion<T>, v: Vector3<T>) -> UnitQuaternion<T> {
    UnitQuaternion::new_unchecked(Quaternion::from_parts(q.w, v))
}
