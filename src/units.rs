//! Each type here wraps the value in the unit the equations use; constructors and accessors name
//! the unit at the door. The vectors are in whatever frame the surrounding type says: readings of
//! the sensor are in the body frame.
//!
//! A conversion is one multiplication: any number has a value in the other unit, and what is not
//! finite stays so. Whoever computes with it says what becomes of that.

use nalgebra::{RealField, Vector3, convert};

/// 1 g in m/s² as the course notes use it (section 2).
///
/// Standard gravity is 9.80665. The difference is 0.03 %, a tenth of the sensor's own scale error
/// (±3 %), and it cancels in the tilt, which depends on the direction of the force only.
pub const METRES_PER_S2_PER_G: f64 = 9.81;

pub(crate) const RADIANS_PER_DEGREE: f64 = core::f64::consts::PI / 180.0;
const DEGREES_PER_RADIAN: f64 = 180.0 / core::f64::consts::PI;

/// A span of time, in seconds: Δt of the equations.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Seconds<T>(pub T);

/// A length in millimetres, the unit the course notes give the eyes' distance in (algorithm 2).
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Millimetres<T>(pub T);

/// An angle, kept in radians and as it is given: no turn is taken off.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Angle<T>(T);

impl<T: RealField + Copy> Angle<T> {
    /// From radians.
    pub fn from_rad(rad: T) -> Self {
        Self(rad)
    }

    /// From degrees.
    pub fn from_degrees(degrees: T) -> Self {
        Self(degrees * convert(RADIANS_PER_DEGREE))
    }

    /// In radians.
    pub fn rad(self) -> T {
        self.0
    }

    /// In degrees.
    pub fn degrees(self) -> T {
        self.0 * convert(DEGREES_PER_RADIAN)
    }

    /// The same angle; zero if it is not finite.
    pub(crate) fn finite_or_zero(self) -> Self {
        Self(if self.0.is_finite() {
            self.0
        } else {
            T::zero()
        })
    }
}

/// How fast something turns about each of three axes, kept in rad/s: ω of the course notes' eq. 1
/// and 17.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngularRate<T>(Vector3<T>);

impl<T: RealField + Copy> AngularRate<T> {
    /// Not turning.
    pub fn zero() -> Self {
        Self(Vector3::zeros())
    }

    /// From radians per second, the unit of the equations.
    pub fn from_rad_per_s(rad_per_s: Vector3<T>) -> Self {
        Self(rad_per_s)
    }

    /// From degrees per second, the unit of the data sheet.
    pub fn from_dps(dps: Vector3<T>) -> Self {
        Self(dps * convert::<f64, T>(RADIANS_PER_DEGREE))
    }

    /// In radians per second.
    pub fn rad_per_s(self) -> Vector3<T> {
        self.0
    }

    /// In degrees per second.
    pub fn dps(self) -> Vector3<T> {
        self.0 * convert::<f64, T>(DEGREES_PER_RADIAN)
    }
}

/// What an accelerometer measures: force per mass, that is acceleration minus gravity, kept in m/s²:
/// a of the course notes' eq. 2.
///
/// At rest it points *up*, away from the pull of the earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpecificForce<T>(Vector3<T>);

impl<T: RealField + Copy> SpecificForce<T> {
    /// From metres per second squared, the unit of the equations.
    pub fn from_m_per_s2(m_per_s2: Vector3<T>) -> Self {
        Self(m_per_s2)
    }

    /// From multiples of g (see [`METRES_PER_S2_PER_G`]), the unit of the data sheet.
    pub fn from_g(g: Vector3<T>) -> Self {
        Self(g * convert::<f64, T>(METRES_PER_S2_PER_G))
    }

    /// In metres per second squared.
    pub fn m_per_s2(self) -> Vector3<T> {
        self.0
    }

    /// In multiples of g (see [`METRES_PER_S2_PER_G`]).
    pub fn g(self) -> Vector3<T> {
        self.0 / convert::<f64, T>(METRES_PER_S2_PER_G)
    }
}

/// 1 G is 100 µT exactly: 1 T is 10⁴ G.
pub const MICROTESLA_PER_GAUSS: f64 = 100.0;

/// What a magnetometer measures: the magnetic flux density along each of three axes, kept in µT. The
/// blog post's m and the gyroscope-emulation paper's B_d, of which they use the direction only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MagneticField<T>(Vector3<T>);

impl<T: RealField + Copy> MagneticField<T> {
    /// From microtesla, the unit of the data sheet.
    pub fn from_microtesla(microtesla: Vector3<T>) -> Self {
        Self(microtesla)
    }

    /// From gauss, the other unit of the course notes (section 1).
    pub fn from_gauss(gauss: Vector3<T>) -> Self {
        Self(gauss * convert::<f64, T>(MICROTESLA_PER_GAUSS))
    }

    /// In microtesla.
    pub fn microtesla(self) -> Vector3<T> {
        self.0
    }

    /// In gauss.
    pub fn gauss(self) -> Vector3<T> {
        self.0 / convert::<f64, T>(MICROTESLA_PER_GAUSS)
    }
}
