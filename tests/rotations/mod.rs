//! Rotations once more, in double precision, with matrices and trigonometry instead of
//! quaternions and series: it shares no arithmetic with the library. And inputs at random.

#![allow(dead_code)] // Every test file uses its own part of this.

use std::f64::consts::PI;

use nalgebra::{Quaternion, RealField, UnitQuaternion, Vector3, convert};
use vrduino::calibration::{GyroBias, Reading};
use vrduino::orientation::TimeConstant;
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, Seconds, SpecificForce};

pub use crate::matrices::*;
pub use crate::random::Random;

/// Eq. 17 and 18.
pub fn gyro(r: &Matrix, rate: Vector, dt: f64) -> Matrix {
    product(r, &turn(rate, dt))
}

/// Eq. 20 to 24. `share` is 1 − α.
pub fn tilt(r: &Matrix, force: Vector, share: f64) -> Matrix {
    let [x, y, z] = apply(r, force);
    let horizontal = x.hypot(z);
    if horizontal == 0.0 {
        return *r;
    }
    let axis = [-z / horizontal, 0.0, x / horizontal];
    product(&rotation(axis, share * horizontal.atan2(y)), r)
}

pub fn reading<T: RealField + Copy>(rad_per_s: [f64; 3], m_per_s2: [f64; 3]) -> Reading<T> {
    let vector = |v: [f64; 3]| Vector3::from(v.map(convert::<f64, T>));
    GyroBias::zero().correct(Sample {
        rate: AngularRate::from_rad_per_s(vector(rad_per_s)),
        force: SpecificForce::from_m_per_s2(vector(m_per_s2)),
    })
}

pub fn components<T: RealField + Copy>(q: &UnitQuaternion<T>) -> [f64; 4] {
    [q.w, q.i, q.j, q.k].map(|c| nalgebra::try_convert::<T, f64>(c).expect("a real number"))
}

/// Eq. 33.
pub fn matrix<T: RealField + Copy>(q: &UnitQuaternion<T>) -> Matrix {
    let [w, x, y, z] = components(q);
    [
        [
            w * w + x * x - y * y - z * z,
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            w * w - x * x + y * y - z * z,
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            w * w - x * x - y * y + z * z,
        ],
    ]
}

#[track_caller]
pub fn assert_is_a_rotation<T: RealField + Copy>(q: &UnitQuaternion<T>, tolerance: f64) {
    let c = components(q);
    let norm = c.iter().map(|c| c * c).sum::<f64>().sqrt();
    // Also false for NaN.
    assert!((norm - 1.0).abs() <= tolerance, "{c:?}");
}

/// Everything a float can be: ordinary, huge, tiny, zero, infinite, and not a number.
pub fn anything(random: &mut Random) -> f64 {
    let sign = if random.unit() < 0.5 { -1.0 } else { 1.0 };
    sign * match (random.unit() * 10.0) as u32 {
        0 => 0.0,
        1 => f64::NAN,
        2 => f64::INFINITY,
        3 => f64::from(f32::MAX),
        4 => f64::from(f32::MIN_POSITIVE),
        5 => f64::from(f32::from_bits(1)),
        6 => f64::from(f32::from_bits(random.unit().to_bits() as u32)),
        _ => 10.0_f64.powf(random.between(-3.0, 4.0)),
    }
}

/// exp of the rotation vector by its series: the solution of Ṙ = R [ω]× for a constant ω, with no
/// trigonometry at all.
pub fn exponential(rotation_vector: Vector) -> Matrix {
    let [x, y, z] = rotation_vector.map(|c| c / 1024.0);
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let (mut sum, mut term) = (IDENTITY, IDENTITY);
    for n in 1..12 {
        term = product(&term, &cross).map(|row| row.map(|c| c / f64::from(n)));
        for (row, more) in sum.iter_mut().zip(term) {
            for (element, more) in row.iter_mut().zip(more) {
                *element += more;
            }
        }
    }
    for _ in 0..10 {
        sum = product(&sum, &sum);
    }
    sum
}

impl Random {
    /// Of unit length, every direction as likely.
    pub fn direction(&mut self) -> Vector {
        loop {
            let v = self.vector(1.0);
            let size = length(v);
            if size > 0.1 && size <= 1.0 {
                return v.map(|c| c / size);
            }
        }
    }

    /// An orientation, every rotation possible.
    pub fn rotation(&mut self) -> Matrix {
        rotation(self.direction(), self.between(-PI, PI))
    }
}

/// Of unit length, every direction as likely: a quaternion no two parts of the library made.
pub fn random_quaternion(random: &mut Random) -> [f64; 4] {
    loop {
        let q = [(); 4].map(|()| random.between(-1.0, 1.0));
        let size = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        if size > 0.1 && size <= 1.0 {
            return q.map(|c| c / size);
        }
    }
}

/// w, x, y, z as they are.
pub fn unit_quaternion<T: RealField + Copy>([w, x, y, z]: [f64; 4]) -> UnitQuaternion<T> {
    let c = convert::<f64, T>;
    UnitQuaternion::new_unchecked(Quaternion::new(c(w), c(x), c(y), c(z)))
}

/// Time constant and sample period of a round: the usual ones, the corners, and then anything.
pub fn times<T: RealField + Copy>(
    round: usize,
    random: &mut Random,
) -> (TimeConstant<T>, Seconds<T>) {
    let (tau, dt) = match round {
        0 => (7.6, 0.001),
        1 => (7.6, 1e30),
        2 => (0.0, 0.001),
        3 => (-0.001, 0.001),
        _ => (anything(random), anything(random)),
    };
    let [tau, dt] = [tau, dt].map(|time| Seconds(convert::<f64, T>(time)));
    (TimeConstant::new(tau), dt)
}
