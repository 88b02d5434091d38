//! What a sensor reports for what is there, and back (course notes, eq. 1 to 4; 001).
//!
//! The notes model from the truth to the measurement, ω̃ = M ω + b + η. The post (001) goes the other
//! way, from the measurement to the truth, and uses the same letters: its ω̃ = A ω + b is the notes'
//! equation solved for ω without the noise, so that A = M⁻¹ and its b is −M⁻¹ times the notes' b.
//! The first is [`MeasurementModel`], the second [`Calibration`].

use crate::units::{AngularRate, METRES_PER_S2_PER_G, MagneticField, SpecificForce};
use nalgebra::{Matrix3, RealField, UnitQuaternion, Vector3, convert};

/// A quantity with three components that a triad of sensors measures.
pub trait Triaxial: Copy {
    /// `f32` or `f64`.
    type Scalar: RealField + Copy;

    /// The components in the unit of the equations: rad/s, m/s² or µT.
    fn components(self) -> Vector3<Self::Scalar>;

    /// From components in that unit.
    fn from_components(components: Vector3<Self::Scalar>) -> Self;
}

impl<T: RealField + Copy> Triaxial for AngularRate<T> {
    type Scalar = T;

    fn components(self) -> Vector3<T> {
        self.rad_per_s()
    }

    fn from_components(components: Vector3<T>) -> Self {
        Self::from_rad_per_s(components)
    }
}

impl<T: RealField + Copy> Triaxial for SpecificForce<T> {
    type Scalar = T;

    fn components(self) -> Vector3<T> {
        self.m_per_s2()
    }

    fn from_components(components: Vector3<T>) -> Self {
        Self::from_m_per_s2(components)
    }
}

impl<T: RealField + Copy> Triaxial for MagneticField<T> {
    type Scalar = T;

    fn components(self) -> Vector3<T> {
        self.microtesla()
    }

    fn from_components(components: Vector3<T>) -> Self {
        Self::from_microtesla(components)
    }
}

/// Eq. 3, and with [`MeasurementModel::aligned`] eq. 1: measured = M · true + b + η.
///
/// Eq. 4, for the accelerometer, is printed without a bias, and for the magnetometer the notes have
/// no equation at all. A real accelerometer has an offset and a real magnetometer sits beside
/// magnetised iron, so the same form serves all three; eq. 4 is this with [`Self::without_bias`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasurementModel<Q: Triaxial> {
    mixing: Matrix3<Q::Scalar>,
    bias: Q,
}

impl<Q: Triaxial> MeasurementModel<Q> {
    /// Eq. 3. `mixing` is M: column j is what a unit along the body's axis j does to the sensors.
    pub fn new(mixing: Matrix3<Q::Scalar>, bias: Q) -> Self {
        Self { mixing, bias }
    }

    /// Eq. 4: a mixing matrix and no bias.
    pub fn without_bias(mixing: Matrix3<Q::Scalar>) -> Self {
        Self::new(mixing, Q::from_components(Vector3::zeros()))
    }

    /// Eq. 1: axes that stand as they should (M = I, what the notes assume from section 2 on).
    pub fn aligned(bias: Q) -> Self {
        Self::new(Matrix3::identity(), bias)
    }

    /// A sensor without fault.
    pub fn ideal() -> Self {
        Self::without_bias(Matrix3::identity())
    }

    /// Eq. 3: what is measured of `truth` (body frame), with this much noise η added. What is not
    /// finite stays so.
    pub fn measured(&self, truth: Q, noise: Q) -> Q {
        let clean = self.mixing * truth.components() + self.bias.components();
        Q::from_components(clean + noise.components())
    }

    /// The calibration that undoes it (001), noise apart. None if M cannot be inverted to half the
    /// digits of the scalar: then two of the axes measure the same, or something is not finite.
    pub fn calibration(&self) -> Option<Calibration<Q>> {
        let (matrix, offset) = solved(&self.mixing, self.bias.components())?;
        Some(Calibration::new(matrix, Q::from_components(offset)))
    }
}

/// 001: true = A · measured + b, its ω̃ = A ω + b. Body frame; b in the unit of the quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration<Q: Triaxial> {
    matrix: Matrix3<Q::Scalar>,
    offset: Q,
}

impl<Q: Triaxial> Calibration<Q> {
    /// From 001's A and b.
    pub fn new(matrix: Matrix3<Q::Scalar>, offset: Q) -> Self {
        Self { matrix, offset }
    }

    /// 001's A.
    pub fn matrix(&self) -> Matrix3<Q::Scalar> {
        self.matrix
    }

    /// 001's b: what a sensor that measures nothing is corrected to.
    pub fn offset(&self) -> Q {
        self.offset
    }

    /// The calibrated measurement, 001's ω̃. What is not finite stays so.
    pub fn corrected(&self, measured: Q) -> Q {
        Q::from_components(self.matrix * measured.components() + self.offset.components())
    }

    /// The model of the sensor this corrects. None as for [`MeasurementModel::calibration`].
    pub fn model(&self) -> Option<MeasurementModel<Q>> {
        let (mixing, bias) = solved(&self.matrix, self.offset.components())?;
        Some(MeasurementModel::new(mixing, Q::from_components(bias)))
    }
}

/// y = N x + c solved for x: (N⁻¹, −N⁻¹ c).
fn solved<T: RealField + Copy>(n: &Matrix3<T>, c: Vector3<T>) -> Option<(Matrix3<T>, Vector3<T>)> {
    let inverse = n.try_inverse()?;
    let offset = -(inverse * c);
    // Rounding leaves a singular matrix a tiny determinant. What then comes out is no inverse.
    let error = n * inverse - Matrix3::identity();
    // False for what is not a number.
    let within = |e: &T| e.abs() < T::default_epsilon().sqrt();
    (error.iter().all(within) && offset.iter().all(|c| c.is_finite())).then_some((inverse, offset))
}

/// Eq. 2 without its noise: a = a⁽ᵍ⁾ + a⁽ˡ⁾ in the body frame, for a body with this orientation
/// (body to world) and this acceleration (**world** frame, m/s²). a⁽ᵍ⁾ points up, 9.81 m/s² long.
pub fn specific_force<T: RealField + Copy>(
    orientation: UnitQuaternion<T>,
    acceleration: Vector3<T>,
) -> SpecificForce<T> {
    let up = Vector3::y() * convert::<f64, T>(METRES_PER_S2_PER_G);
    SpecificForce::from_m_per_s2(orientation.inverse() * (up + acceleration))
}
