//! Rotations as plain arrays in double precision: no quaternion, and nothing of the library.

#![allow(dead_code)] // Every test file uses its own part of this.

pub type Vector = [f64; 3];
pub type Matrix = [[f64; 3]; 3];

pub const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

pub fn apply(a: &Matrix, v: Vector) -> Vector {
    [0, 1, 2].map(|i| (0..3).map(|k| a[i][k] * v[k]).sum())
}

pub fn transpose(a: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i]))
}

pub fn length(v: Vector) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Rodrigues: about a unit axis by an angle in radians.
pub fn rotation(axis: Vector, angle: f64) -> Matrix {
    let ([x, y, z], (s, c)) = (axis, angle.sin_cos());
    let d = 1.0 - c;
    [
        [c + x * x * d, x * y * d - z * s, x * z * d + y * s],
        [y * x * d + z * s, c + y * y * d, y * z * d - x * s],
        [z * x * d - y * s, z * y * d + x * s, c + z * z * d],
    ]
}

/// The turn of a body at a constant rate for a time, body to world.
pub fn turn(rate: Vector, time: f64) -> Matrix {
    let size = length(rate);
    if size == 0.0 {
        return IDENTITY;
    }
    rotation(rate.map(|w| w / size), size * time)
}

/// The angle between two orientations, in radians, by the trace and the skew part of aᵀb.
pub fn angle_between(a: &Matrix, b: &Matrix) -> f64 {
    let r = product(&transpose(a), b);
    let sin = (r[2][1] - r[1][2])
        .hypot(r[0][2] - r[2][0])
        .hypot(r[1][0] - r[0][1]);
    sin.atan2(r[0][0] + r[1][1] + r[2][2] - 1.0)
}

/// The same in degrees.
pub fn degrees_between(a: &Matrix, b: &Matrix) -> f64 {
    angle_between(a, b).to_degrees()
}

/// The larger of the two; not a number if either is not, which `f64::max` would pass over.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// The largest difference of two matrices' elements.
pub fn largest_difference(a: &Matrix, b: &Matrix) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, larger)
}
