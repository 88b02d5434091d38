//! The head turns about the base of the neck, not about the sensor (course notes, section 5.4.2,
//! algorithm 3; lectures, “Head and Neck Model”): so looking up also moves the eyes back and down,
//! and leaning the head over moves them aside. That is the motion parallax that can be had without
//! tracking positions.
//!
//! As printed, T(0, −l_n, −l_h) R⁻¹ T(0, l_n, l_h), the point that stays put is (0, −l_n, −l_h): below
//! the eyes, but with the camera looking along −z *in front* of the face. Here it is
//! (0, −l_n, +l_h), behind them.

use super::eyes::measure;
use super::{ViewError, unit};
use crate::units::Millimetres;
use nalgebra::{Isometry3, Point3, RealField, Translation3, UnitQuaternion};

/// Where the head's centre of rotation is, as seen from the middle between the eyes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadNeck<T> {
    neck: Millimetres<T>,
    head: Millimetres<T>,
}

impl<T: RealField + Copy> HeadNeck<T> {
    /// `neck` is l_n, how far the centre is below the eyes; `head` is l_h, how far behind them,
    /// half the length of the head.
    ///
    /// # Errors
    ///
    /// [`ViewError::Measure`] unless both are from 0 to 1000 mm.
    pub fn new(neck: Millimetres<T>, head: Millimetres<T>) -> Result<Self, ViewError> {
        Ok(Self {
            neck: measure(neck)?,
            head: measure(head)?,
        })
    }

    /// No neck: the head turns about the middle between the eyes, as in algorithm 2.
    pub fn none() -> Self {
        Self {
            neck: Millimetres(T::zero()),
            head: Millimetres(T::zero()),
        }
    }

    /// The point that does not move when the head turns: (0, −l_n, l_h) mm, in the frame of the
    /// head, and of the world while the head is at rest.
    pub fn pivot(self) -> Point3<T> {
        Point3::new(T::zero(), -self.neck.0, self.head.0)
    }

    /// From the world to the frame of the head: T(0, −l_n, l_h) R⁻¹ T(0, l_n, −l_h), where R is the
    /// turn of the head, body to world.
    ///
    /// # Errors
    ///
    /// [`ViewError::NotARotation`] if the quaternion is zero or not finite.
    pub fn to_head(self, head: UnitQuaternion<T>) -> Result<Isometry3<T>, ViewError> {
        let pivot = Translation3::from(self.pivot().coords);
        Ok(pivot * unit(head)?.inverse() * pivot.inverse())
    }
}
