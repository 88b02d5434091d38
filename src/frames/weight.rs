//! What α weighs. In the course notes and lectures it is the share of the gyro in one sample
//! (eq. 9 and 24), near 1; in the blog post the share of the drift that is corrected, near 0.
//!
//! The two corrections look further apart than they are: the notes turn by +(1 − α)φ about
//! n = v × y, the post by −αφ about t = (u_z, 0, −u_x) = y × u. That is −n, so the turn is the same.

use nalgebra::RealField;

/// The weight of the gyro in one sample, α of the course notes, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct GyroWeight<T>(T);

impl<T: RealField + Copy> GyroWeight<T> {
    /// From α of the notes. None unless it is from 0 to 1.
    pub fn new(alpha: T) -> Option<Self> {
        (alpha >= T::zero() && alpha <= T::one()).then_some(Self(alpha))
    }

    /// From α of the blog post. None unless it is from 0 to 1.
    pub fn from_correction_gain(alpha: T) -> Option<Self> {
        (alpha >= T::zero() && alpha <= T::one()).then(|| Self(T::one() - alpha))
    }

    /// α of the notes.
    pub fn alpha(self) -> T {
        self.0
    }

    /// α of the blog post: 1 − α of the notes.
    pub fn correction_gain(self) -> T {
        T::one() - self.0
    }
}
