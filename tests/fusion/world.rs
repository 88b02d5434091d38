//! A sensor in a world of plain arrays: y up, −z to magnetic north.

use nalgebra::{RealField, UnitQuaternion, Vector3, convert, try_convert};
use vrduino::fusion::{Fusion, Parameters, Rates};
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, MagneticField, Seconds, SpecificForce};

use crate::matrices::{IDENTITY, Matrix, Vector, apply, product, transpose, turn};

pub const DT: f64 = 0.001;
pub const G: f64 = 9.81;
/// 20 µT north and 40 µT down.
pub const EARTH: Vector = [0.0, -40.0, -20.0];
const DEGREE: f64 = std::f64::consts::PI / 180.0;

pub fn dps(rate: Vector) -> Vector {
    rate.map(|component| component * DEGREE)
}

pub fn fusion<T: RealField + Copy>(parameters: &Parameters<T>) -> Fusion<T> {
    let period = Seconds(convert(DT));
    Fusion::new(
        parameters,
        Rates {
            sample: period,
            field: period,
        },
    )
}

pub fn sample<T: RealField + Copy>(rate: Vector, force: Vector) -> Sample<T> {
    let vector = |v: Vector| Vector3::from(v).map(convert::<f64, T>);
    Sample {
        rate: AngularRate::from_rad_per_s(vector(rate)),
        force: SpecificForce::from_m_per_s2(vector(force)),
    }
}

pub fn field<T: RealField + Copy>(field: Vector) -> MagneticField<T> {
    MagneticField::from_microtesla(Vector3::from(field).map(convert::<f64, T>))
}

/// Body to world, by turning the three axes.
pub fn matrix<T: RealField + Copy>(q: &UnitQuaternion<T>) -> Matrix {
    let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| q * axis);
    let element = |value: T| try_convert(value).unwrap_or(f64::NAN);
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| element(columns[column][row])))
}

/// A sensor that turns as it is told, with a bias and in a field of its own.
pub struct Body {
    pub attitude: Matrix,
    /// rad/s.
    pub bias: Vector,
    /// µT, world.
    pub field: Vector,
}

impl Body {
    pub fn level() -> Body {
        Body {
            attitude: IDENTITY,
            bias: [0.0; 3],
            field: EARTH,
        }
    }

    /// Turns for one sample at this rate (rad/s, body) with this acceleration (m/s², world), and is read.
    pub fn read(&mut self, rate: Vector, acceleration: Vector) -> (Vector, Vector, Vector) {
        self.attitude = product(&self.attitude, &turn(rate, DT));
        let [x, y, z] = acceleration;
        let to_body = transpose(&self.attitude);
        (
            [0, 1, 2].map(|i| rate[i] + self.bias[i]),
            apply(&to_body, [x, y + G, z]),
            apply(&to_body, self.field),
        )
    }
}
