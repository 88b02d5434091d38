//! Rotations as plain arrays in double precision: no quaternion, no nalgebra.

pub type Vector = [f64; 3];
pub type Matrix = [[f64; 3]; 3];

pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

pub fn apply(a: &Matrix, v: Vector) -> Vector {
    [0, 1, 2].map(|i| (0..3).map(|k| a[i][k] * v[k]).sum())
}

pub fn transpose(a: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i]))
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

/// Reproducible random numbers (xorshift64*).
pub struct Random(pub u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn vector(&mut self, size: f64) -> Vector {
        [(); 3].map(|()| self.between(-size, size))
    }

    /// A unit vector; the six axes themselves now and then.
    pub fn direction(&mut self) -> Vector {
        loop {
            let mut v = self.vector(1.0);
            if self.unit() < 0.02 {
                let axis = self.between(0.0, 3.0) as usize;
                v = [0, 1, 2].map(|i| if i == axis { v[i].signum() } else { 0.0 });
            }
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            if (0.1..=1.0).contains(&length) {
                return v.map(|x| x / length);
            }
        }
    }
}

/// Any rotation; quarter and half turns, none, and hardly any now and then.
pub fn axis_angle(random: &mut Random) -> (Vector, f64) {
    use std::f64::consts::{FRAC_PI_2, PI};
    let axis = random.direction();
    let angle = match random.between(0.0, 50.0) as usize {
        0 => 0.0,
        1 => PI,
        2 => FRAC_PI_2,
        3 => 1e-9,
        4 => PI - 1e-9,
        _ => random.between(-PI, PI),
    };
    (axis, angle)
}
