//! The first-order Butterworth low-pass filter (section 3.2.1):
//!
//! ```text
//!          b₀ + b₁ z⁻¹
//! H(z) = ───────────────
//!           1 + a₁ z⁻¹
//! ```

use super::fields::{Fields, NoAttitude};
use nalgebra::{RealField, convert};

/// A cut-off frequency F_c as a fraction of the sampling frequency F_e, above 0 and below ½.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct CutOff<T>(T);

impl<T: RealField + Copy> CutOff<T> {
    /// F_c/F_e. None outside (0, ½): from half the sampling frequency on there is nothing to cut.
    pub fn new(fraction: T) -> Option<Self> {
        (fraction > T::zero() && fraction < convert(0.5)).then_some(Self(fraction))
    }

    /// For the library's own constants, which are inside.
    pub(super) fn of(fraction: f64) -> Self {
        Self(convert(fraction))
    }

    /// F_c/F_e.
    pub fn fraction(self) -> T {
        self.0
    }
}

/// What the filter multiplies with: b₀, b₁ and a₁ of H(z), without unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients<T> {
    /// Weight of the present input.
    pub b0: T,
    /// Weight of the input before.
    pub b1: T,
    /// Minus the weight of the output before.
    pub a1: T,
}

impl<T: RealField + Copy> Coefficients<T> {
    /// By the bilinear transform, pre-warped so that the gain at F_c is 1/√2 exactly:
    /// b₀ = b₁ = K/(1 + K), a₁ = (K − 1)/(K + 1) with K = tan(π F_c/F_e).
    ///
    /// At F_c = 0.02 F_e these are (0.0592, 0.0592, −0.8816). The printed default, (0.0305, 0.0305,
    /// −0.9391), is for half of it: the design program counts in multiples of F_e/2. The gain at
    /// zero frequency is 1 for every cut-off.
    pub fn new(cut_off: CutOff<T>) -> Self {
        let k = (T::pi() * cut_off.fraction()).tan();
        let b = k / (T::one() + k);
        Self {
            b0: b,
            b1: b,
            a1: (k - T::one()) / (k + T::one()),
        }
    }
}

/// The filter on both fields at once, so that they stay in phase.
///
/// Its state is the last input and the last output, not a sum formed with the coefficients:
/// changing the coefficients in mid-run leaves a settled output where it is.
#[derive(Clone, Copy, Debug)]
pub struct LowPass<T> {
    coefficients: Coefficients<T>,
    last: Option<Last<T>>,
}

#[derive(Clone, Copy, Debug)]
struct Last<T> {
    input: Fields<T>,
    output: Fields<T>,
}

impl<T: RealField + Copy> LowPass<T> {
    /// Without a past: the first sample passes as if it had always been there.
    pub fn new(cut_off: CutOff<T>) -> Self {
        Self {
            coefficients: Coefficients::new(cut_off),
            last: None,
        }
    }

    /// Another cut-off from the next sample on.
    pub fn set_cut_off(&mut self, cut_off: CutOff<T>) {
        self.coefficients = Coefficients::new(cut_off);
    }

    /// One sample in, one out.
    ///
    /// # Errors
    ///
    /// [`NoAttitude::NotFinite`]; the sample is left out.
    pub fn update(&mut self, input: Fields<T>) -> Result<Fields<T>, NoAttitude> {
        let input = input.plausible()?;
        let last = self.last.unwrap_or(Last {
            input,
            output: input,
        });
        let Coefficients { b0, b1, a1 } = self.coefficients;
        let output = Fields {
            gravity: input.gravity * b0 + last.input.gravity * b1 - last.output.gravity * a1,
            magnetic: input.magnetic * b0 + last.input.magnetic * b1 - last.output.magnetic * a1,
        };
        self.last = Some(Last { input, output });
        Ok(output)
    }
}
