//! Rotations as plain matrices: no quaternion, and nothing of the library.

pub type Vector = [f64; 3];
pub type Matrix = [[f64; 3]; 3];

pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut c = [[0.0; 3]; 3];
    for (i, row) in c.iter_mut().enumerate() {
        for (j, element) in row.iter_mut().enumerate() {
            *element = (0..3).map(|k| a[i][k] * b[k][j]).sum();
        }
    }
    c
}

pub fn apply(a: &Matrix, v: Vector) -> Vector {
    [0, 1, 2].map(|i| (0..3).map(|k| a[i][k] * v[k]).sum())
}

pub fn transpose(a: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i]))
}

/// R_z(−θ_z) R_x(−θ_x) R_y(−θ_y) of eq. 10, as it is printed there.
pub fn eq_10(yaw: f64, pitch: f64, roll: f64) -> Matrix {
    let (sz, cz) = (-roll).sin_cos();
    let (sx, cx) = (-pitch).sin_cos();
    let (sy, cy) = (-yaw).sin_cos();
    let about_z = [[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]];
    let about_x = [[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]];
    let about_y = [[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]];
    product(&product(&about_z, &about_x), &about_y)
}

/// Rodrigues: the turn of a body at a constant rate for a time, body to world.
pub fn turn(rate: Vector, time: f64) -> Matrix {
    let size = rate.iter().map(|w| w * w).sum::<f64>().sqrt();
    let [x, y, z] = rate.map(|w| if size == 0.0 { 0.0 } else { w / size });
    let (s, c) = (size * time).sin_cos();
    let d = 1.0 - c;
    [
        [c + x * x * d, x * y * d - z * s, x * z * d + y * s],
        [y * x * d + z * s, c + y * y * d, y * z * d - x * s],
        [z * x * d - y * s, z * y * d + x * s, c + z * z * d],
    ]
}

/// By how many degrees two orientations differ.
pub fn degrees_between(a: &Matrix, b: &Matrix) -> f64 {
    let r = product(&transpose(a), b);
    let cos = r[0][0] + r[1][1] + r[2][2] - 1.0;
    let sin = (r[2][1] - r[1][2])
        .hypot(r[0][2] - r[2][0])
        .hypot(r[1][0] - r[0][1]);
    sin.atan2(cos).to_degrees()
}
