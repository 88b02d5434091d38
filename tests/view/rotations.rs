//! Rotations at random, with the corners among them.

pub use crate::matrices::{Matrix, Vector, apply, larger, length, product, rotation, transpose};
pub use crate::random::Random;

impl Random {
    /// A unit vector; the six axes themselves now and then.
    pub fn direction(&mut self) -> Vector {
        loop {
            let mut v = self.vector(1.0);
            if self.unit() < 0.02 {
                let axis = self.between(0.0, 3.0) as usize;
                v = [0, 1, 2].map(|i| if i == axis { v[i].signum() } else { 0.0 });
            }
            let size = length(v);
            if (0.1..=1.0).contains(&size) {
                return v.map(|x| x / size);
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
