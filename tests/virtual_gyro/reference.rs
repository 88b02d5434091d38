//! Section 3.1 once more: plain arrays, no quaternion, nothing of the library's arithmetic.

use nalgebra::{RealField, Rotation3, UnitQuaternion, Vector3, convert, try_convert};
use vrduino::virtual_gyro::{Directions, Fields, TaitBryan};

pub use crate::matrices::{
    Matrix, Vector, apply, degrees_between, larger, largest_difference, product, rotation as about,
    transpose,
};
pub use crate::random::Random;

/// The three matrices of section 3.1, as printed.
pub fn rz(psi: f64) -> Matrix {
    let (s, c) = psi.sin_cos();
    [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]
}

pub fn ry(theta: f64) -> Matrix {
    let (s, c) = theta.sin_cos();
    [[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]]
}

pub fn rx(phi: f64) -> Matrix {
    let (s, c) = phi.sin_cos();
    [[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]]
}

/// R(φ, θ, ψ), reference to device.
pub fn r([phi, theta, psi]: Vector) -> Matrix {
    product(&rx(phi), &product(&ry(theta), &rz(psi)))
}

pub fn apart(a: Vector, b: Vector) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, larger)
}

/// g_r and B_r (9.81 m/s² and 48 µT) turned into the device frame by R.
pub fn seen<T: RealField + Copy>(attitude: &Matrix, dip: f64) -> Fields<T> {
    Fields {
        gravity: vector(apply(attitude, [0.0, 0.0, 9.81])),
        magnetic: vector(apply(attitude, [48.0 * dip.cos(), 0.0, 48.0 * dip.sin()])),
    }
}

pub fn directions<T: RealField + Copy>(attitude: &Matrix, dip: f64) -> Directions<T> {
    seen(attitude, dip).directions().expect("both fields show")
}

pub fn vector<T: RealField + Copy>(v: Vector) -> Vector3<T> {
    Vector3::from(v.map(convert::<f64, T>))
}

pub fn number<T: RealField + Copy>(x: T) -> f64 {
    try_convert(x).expect("a real number")
}

pub fn array<T: RealField + Copy>(v: Vector3<T>) -> Vector {
    [v.x, v.y, v.z].map(number)
}

pub fn rows<T: RealField + Copy>(m: &Rotation3<T>) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| number(m[(i, j)])))
}

pub fn rad<T: RealField + Copy>(angles: &TaitBryan<T>) -> Vector {
    [angles.roll, angles.pitch, angles.yaw].map(|angle| number(angle.rad()))
}

/// The matrix of a quaternion from the sandwich of eq. 6 on the axes, scalar last.
pub fn sandwich([x, y, z, w]: [f64; 4]) -> Matrix {
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|[a, b, c]| {
        let [x, y, z, _] = hamilton(hamilton([x, y, z, w], [a, b, c, 0.0]), [-x, -y, -z, w]);
        [x, y, z]
    });
    transpose(&columns)
}

/// Eq. 5, by i² = j² = k² = −1 and ij = k, scalar last.
pub fn hamilton([a, b, c, d]: [f64; 4], [e, f, g, h]: [f64; 4]) -> [f64; 4] {
    [
        d * e + a * h + b * g - c * f,
        d * f - a * g + b * h + c * e,
        d * g + a * f - b * e + c * h,
        d * h - a * e - b * f - c * g,
    ]
}

/// q₁ q₂ q₃ q₄.
pub fn scalar_last<T: RealField + Copy>(q: &UnitQuaternion<T>) -> [f64; 4] {
    [q.i, q.j, q.k, q.w].map(number)
}

/// The other quaternion of the same attitude.
pub fn negated(q: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(-q.into_inner())
}

impl Random {
    /// φ, θ, ψ over their ranges; every eighth close to or at θ = ±π/2, or upside down.
    pub fn attitude(&mut self) -> Vector {
        use std::f64::consts::{FRAC_PI_2, PI};
        let phi = self.between(-PI, PI);
        let psi = self.between(-PI, PI);
        let theta = self.between(-FRAC_PI_2, FRAC_PI_2);
        match (self.unit() * 32.0) as u32 {
            0 => [phi, FRAC_PI_2, psi],
            1 => [phi, -FRAC_PI_2, psi],
            2 => {
                let near = 10_f64.powf(self.between(-16.0, -1.0));
                [phi, (FRAC_PI_2 - near) * theta.signum(), psi]
            }
            3 => [PI, theta * 1e-3, psi],
            _ => [phi, theta, psi],
        }
    }
}
