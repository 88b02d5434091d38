//! The projection matrix (lectures, recap of lecture 2: v_clip = M_proj M_view M_model v;
//! `setProjectionMatrix` of algorithms 2 and 3). The documents name it and leave it to OpenGL, so
//! this is OpenGL's: what is enclosed by the planes becomes the cube from −1 to 1 after division
//! by w, the near plane at −1.

use super::ViewError;
use crate::units::{Angle, Millimetres};
use nalgebra::{Matrix4, RealField, convert};

/// The edges of the near plane, in the camera's x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window<T> {
    /// The lesser x.
    pub left: Millimetres<T>,
    /// The greater x.
    pub right: Millimetres<T>,
    /// The lesser y.
    pub bottom: Millimetres<T>,
    /// The greater y.
    pub top: Millimetres<T>,
}

/// How far along −z the picture begins and ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth<T> {
    /// To the near plane.
    pub near: Millimetres<T>,
    /// To the far plane.
    pub far: Millimetres<T>,
}

/// A perspective projection, camera to clip space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection<T: RealField>(Matrix4<T>);

impl<T: RealField + Copy> Projection<T> {
    /// Through a window that need not be straight ahead (`glFrustum`): each eye of a headset sits
    /// beside the middle of its half of the screen.
    ///
    /// # Errors
    ///
    /// [`ViewError::NoVolume`] if the planes enclose none, or a number is not finite.
    pub fn through(window: Window<T>, depth: Depth<T>) -> Result<Self, ViewError> {
        let (near, far) = (depth.near.0, depth.far.0);
        let (width, height) = (
            window.right.0 - window.left.0,
            window.top.0 - window.bottom.0,
        );
        let (zero, one, two) = (T::zero(), T::one(), convert::<f64, T>(2.0));
        // Written so that what is not a number fails.
        if !(near > zero && far > near && width > zero && height > zero) {
            return Err(ViewError::NoVolume);
        }
        let range = far - near;
        let matrix = Matrix4::new(
            two * (near / width),
            zero,
            (window.right.0 + window.left.0) / width,
            zero,
            zero,
            two * (near / height),
            (window.top.0 + window.bottom.0) / height,
            zero,
            zero,
            zero,
            -(far + near) / range,
            -two * near * (far / range),
            zero,
            zero,
            -one,
            zero,
        );
        if matrix.iter().all(|element| element.is_finite()) {
            Ok(Self(matrix))
        } else {
            Err(ViewError::NoVolume)
        }
    }

    /// Straight ahead (`gluPerspective`): `field_of_view` is the whole angle from bottom to top,
    /// `aspect` the width of the picture over its height.
    ///
    /// # Errors
    ///
    /// [`ViewError::NoVolume`] unless 0° < field of view < 180°, aspect > 0 and 0 < near < far.
    pub fn straight(
        field_of_view: Angle<T>,
        aspect: T,
        depth: Depth<T>,
    ) -> Result<Self, ViewError> {
        let half = field_of_view.rad() * convert(0.5);
        if !(half > T::zero() && half < T::frac_pi_2()) {
            return Err(ViewError::NoVolume);
        }
        let top = depth.near.0 * half.tan();
        let right = top * aspect;
        Self::through(
            Window {
                left: Millimetres(-right),
                right: Millimetres(right),
                bottom: Millimetres(-top),
                top: Millimetres(top),
            },
            depth,
        )
    }

    /// M_proj, camera to clip space, for homogeneous columns (x, y, z, 1).
    pub fn matrix(self) -> Matrix4<T> {
        self.0
    }
}
