//! Algorithms 2 and 3 of the course notes, call by call as printed.

use crate::camera::Camera;
use crate::rotations::rotation;
use nalgebra::{Matrix4, Vector3};

/// A fixed-function OpenGL: every call multiplies the current matrix from the right.
pub struct Gl(Matrix4<f64>);

impl Gl {
    pub fn new() -> Self {
        Self(Matrix4::identity())
    }
    pub fn rotate(&mut self, degrees: f64, axis: [f64; 3]) -> &mut Self {
        let r = rotation(axis, degrees.to_radians());
        self.0 *= Matrix4::from_fn(|i, j| match (i < 3, j < 3) {
            (true, true) => r[i][j],
            _ => f64::from(u8::from(i == j)),
        });
        self
    }
    pub fn translate(&mut self, x: f64, y: f64, z: f64) -> &mut Self {
        self.0 *= Matrix4::new_translation(&Vector3::new(x, y, z));
        self
    }
    /// setLookAtMatrix(x, 0, 0, x, 0, -1, 0, 1, 0).
    pub fn look_ahead_from(&mut self, x: f64) -> &mut Self {
        self.translate(-x, 0.0, 0.0)
    }
    pub fn draw(&self) -> Matrix4<f64> {
        self.0
    }
}

/// Algorithm 2 as printed: rotate, then look at.
pub fn printed_algorithm_2(axis: [f64; 3], degrees: f64, eye: f64) -> Camera {
    let mut gl = Gl::new();
    Camera::of(&gl.rotate(-degrees, axis).look_ahead_from(eye).draw())
}

/// Algorithm 3 as printed, the board aligned; with an eye in the middle it is lecture 003's and
/// 004's T(0, -l_n, -l_h) R T(0, l_n, l_h) T(-eye) as well.
pub fn printed_algorithm_3(axis: [f64; 3], degrees: f64, neck: f64, head: f64, eye: f64) -> Camera {
    let mut gl = Gl::new();
    gl.translate(0.0, -neck, -head).rotate(-degrees, axis);
    gl.translate(0.0, neck, head).look_ahead_from(eye);
    Camera::of(&gl.draw())
}
