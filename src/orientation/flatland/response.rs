//! What the complementary filter does to each frequency (course notes, section 3.3).
//!
//! Eq. 9 in terms of the angle of eq. 7, with z⁻¹ for a delay of one sample:
//!
//! ```text
//! θ = H(z) θ_gyro + L(z) θ_acc    H = α(1 − z⁻¹)/(1 − αz⁻¹)    L = (1 − α)/(1 − αz⁻¹)
//! ```
//!
//! H is a high pass, L a low pass, and H + L = 1 at every frequency: where both sensors tell the
//! truth, so does the filter, with neither delay nor damping.

use crate::orientation::TimeConstant;
use crate::units::Seconds;
use nalgebra::{Complex, RealField, convert};

/// The two transfer functions of one filter of eq. 9. They have no unit.
#[derive(Clone, Copy, Debug)]
pub struct Response<T> {
    sample_period: Seconds<T>,
    accelerometer_weight: T,
}

impl<T: RealField + Copy> Response<T> {
    /// Of the filter with this time constant.
    pub fn new(time_constant: TimeConstant<T>, sample_period: Seconds<T>) -> Self {
        Self {
            sample_period,
            accelerometer_weight: time_constant.accelerometer_weight(sample_period),
        }
    }

    /// L: what becomes of an oscillation of the accelerometer's angle. Its modulus is the gain, its
    /// argument the phase. None if the frequency (Hz) or its phase per sample is not finite.
    pub fn low_pass(&self, hertz: T) -> Option<Complex<T>> {
        let (low, _) = self.at(hertz)?;
        Some(low)
    }

    /// H: what becomes of an oscillation of the gyro's angle. As [`Self::low_pass`] otherwise.
    pub fn high_pass(&self, hertz: T) -> Option<Complex<T>> {
        let (_, high) = self.at(hertz)?;
        Some(high)
    }

    fn at(&self, hertz: T) -> Option<(Complex<T>, Complex<T>)> {
        let half_phase = T::pi() * hertz * self.sample_period.0;
        if !half_phase.is_finite() {
            return None;
        }
        let (sin, cos) = half_phase.sin_cos();
        let two: T = convert(2.0);
        // 1 − z⁻¹ = r + i s. Written with half the angle, it keeps its digits at low frequencies.
        let (r, s) = (two * sin * sin, two * sin * cos);
        let weight = self.accelerometer_weight;
        let alpha = T::one() - weight;
        // 1 − αz⁻¹ = (1 − α) + α(1 − z⁻¹).
        let (re, im) = (weight + alpha * r, alpha * s);
        let squared = re * re + im * im;
        if squared.is_zero() {
            // α = 1 at zero frequency: the accelerometer is never asked.
            return Some((
                Complex::new(T::zero(), T::zero()),
                Complex::new(T::one(), T::zero()),
            ));
        }
        let over =
            |a: T, b: T| Complex::new((a * re + b * im) / squared, (b * re - a * im) / squared);
        Some((over(weight, T::zero()), over(alpha * r, alpha * s)))
    }
}
