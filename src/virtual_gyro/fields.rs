//! What the two sensors see of the earth (section 3.1).

use crate::units::{Angle, METRES_PER_S2_PER_G, MagneticField, SpecificForce};
use core::fmt;
use nalgebra::{RealField, Rotation3, Vector3, convert};

/// Below this there is no saying where down is: free fall. In multiples of g; the data sheet lets
/// the accelerometer's own zero be off by as much.
const FREE_FALL_G: f64 = 0.06;

/// No accelerometer and no magnetometer reads as much, whatever its unit; and the squares of
/// smaller numbers are finite.
const IMPLAUSIBLE: f64 = 1e9;

/// The earth's two fields where the device is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Earth<T> {
    /// g, in m/s². (The paper says newtons; it is an acceleration.)
    pub gravity: T,
    /// B, in µT.
    pub field: T,
    /// δ: how far the magnetic field points below the horizon.
    pub dip: Angle<T>,
}

impl<T: RealField + Copy> Earth<T> {
    /// The fields in the reference frame: g_r = (0, 0, g) and B_r = (B cos δ, 0, B sin δ). What is not
    /// finite stays so, and [`Fields::directions`] says so.
    pub fn in_reference(&self) -> Fields<T> {
        let (sin, cos) = self.dip.rad().sin_cos();
        Fields {
            gravity: Vector3::z() * self.gravity,
            magnetic: Vector3::new(cos, T::zero(), sin) * self.field,
        }
    }

    /// Eq. 1 and 2: the fields as a device sees them; `attitude` is reference to device.
    pub fn in_device(&self, attitude: &Rotation3<T>) -> Fields<T> {
        let reference = self.in_reference();
        Fields {
            gravity: attitude * reference.gravity,
            magnetic: attitude * reference.magnetic,
        }
    }
}

/// Gravity and magnetic field at one instant, in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fields<T> {
    /// m/s², pointing **down**.
    pub gravity: Vector3<T>,
    /// µT; only its direction plays a part.
    pub magnetic: Vector3<T>,
}

impl<T: RealField + Copy> Fields<T> {
    /// Readings in the device frame: g_d = −a, since a resting accelerometer reads the force that
    /// holds it up.
    pub fn from_readings(force: SpecificForce<T>, magnetic: MagneticField<T>) -> Self {
        Self {
            gravity: -force.m_per_s2(),
            magnetic: magnetic.microtesla(),
        }
    }

    /// The sample itself, if a sensor can have read it: what the filters take in. One number that is
    /// not finite would stay in a recursive filter for ever.
    pub(super) fn plausible(self) -> Result<Self, NoAttitude> {
        let mut components = self.gravity.iter().chain(self.magnetic.iter());
        // Not a number is not below it either.
        if components.all(|component| component.abs() < convert(IMPLAUSIBLE)) {
            Ok(self)
        } else {
            Err(NoAttitude::NotFinite)
        }
    }

    /// Where the two fields point.
    ///
    /// # Errors
    ///
    /// [`NoAttitude`] says which of the two is of no use, and why.
    pub fn directions(&self) -> Result<Directions<T>, NoAttitude> {
        let (gravity, size) = unit(self.gravity)?;
        if size < convert(FREE_FALL_G * METRES_PER_S2_PER_G) {
            return Err(NoAttitude::FreeFall);
        }
        let (magnetic, size) = unit(self.magnetic)?;
        if size.is_zero() {
            return Err(NoAttitude::NoMagneticField);
        }
        let across = gravity.cross(&magnetic);
        let sine = across.norm();
        if sine < T::default_epsilon().sqrt() {
            return Err(NoAttitude::FieldsParallel);
        }
        // Near a magnetic pole the cross product is mostly rounding; what of it lies along
        // gravity is taken out.
        let east = across / sine;
        let east = (east - gravity * gravity.dot(&east)).normalize();
        Ok(Directions {
            gravity,
            magnetic,
            east,
        })
    }
}

/// The vector at unit length, and the length it had.
fn unit<T: RealField + Copy>(v: Vector3<T>) -> Result<(Vector3<T>, T), NoAttitude> {
    if !v.iter().all(|component| component.is_finite()) {
        return Err(NoAttitude::NotFinite);
    }
    // The largest component becomes ±1, so that the squares neither overflow nor all vanish.
    let largest = v.amax();
    if largest.is_zero() {
        return Ok((v, largest));
    }
    let scaled = v / largest;
    let length = scaled.norm();
    Ok((scaled / length, largest * length))
}

/// Unit vectors along the two fields, finite and not parallel: whatever is computed from them is
/// defined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directions<T> {
    gravity: Vector3<T>,
    magnetic: Vector3<T>,
    east: Vector3<T>,
}

impl<T: RealField + Copy> Directions<T> {
    /// g_dN: down.
    pub fn gravity(&self) -> Vector3<T> {
        self.gravity
    }

    /// B_dN: along the magnetic field.
    pub fn magnetic(&self) -> Vector3<T> {
        self.magnetic
    }

    /// C_dN = g_d × B_d at unit length: magnetic east.
    pub fn east(&self) -> Vector3<T> {
        self.east
    }

    /// δ as measured: sin δ = g_dN · B_dN.
    ///
    /// By the arc tangent of sine and cosine, which keeps its digits for a steep field too.
    pub fn dip(&self) -> Angle<T> {
        let sin = self.gravity.dot(&self.magnetic);
        let cos = self.gravity.cross(&self.magnetic).norm();
        Angle::from_rad(sin.atan2(cos))
    }
}

/// Why two readings do not tell an attitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoAttitude {
    /// A component is NaN, infinite, or larger than any sensor reads.
    NotFinite,
    /// Hardly any gravity (below 60 mg): the device falls, and nothing tells where down is.
    FreeFall,
    /// The magnetometer reads zero, or there is none.
    NoMagneticField,
    /// The field is vertical (dip ±90°), as at a magnetic pole: nothing tells north. Closer than
    /// half the digits of the scalar: within 0.02° in `f32`, 1e-6° in `f64`.
    FieldsParallel,
}

impl fmt::Display for NoAttitude {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "a reading is not a finite number: leave the sample out",
            Self::FreeFall => "no gravity, the device is falling: wait until it is held",
            Self::NoMagneticField => "no magnetic field: check that the magnetometer is running",
            Self::FieldsParallel => "the magnetic field is vertical and shows no north: move away from the magnet or pole",
        })
    }
}

impl core::error::Error for NoAttitude {}
