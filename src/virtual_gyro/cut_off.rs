//! The adaptive cut-off (section 3.2.1): the filter opens while gravity changes its length, and
//! closes step by step when it no longer does.

use super::butterworth::CutOff;
use nalgebra::{RealField, convert};

/// F_c/F_e at rest.
pub const LOWEST: f64 = 0.02;

/// F_c/F_e that is not exceeded.
pub const HIGHEST: f64 = 0.4;

/// How far one sample moves it.
pub const STEP: f64 = 0.05;

/// Δ_gd/‖g_d‖: a norm that changes by more is changing.
pub const THRESHOLD: f64 = 0.01;

/// F_c from the norm of the extracted gravity.
///
/// The paper leaves two things open. Over what interval the norm varies: here, from one sample of
/// g_d to the next. And what becomes of steps that do not end on the limits (0.02 + 0.05 k is
/// 0.37, then 0.42; 0.4 − 0.05 k is 0.05, then 0): here, the limit is taken.
#[derive(Clone, Copy, Debug)]
pub struct AdaptiveCutOff<T> {
    fraction: T,
    norm: Option<T>,
}

impl<T: RealField + Copy> AdaptiveCutOff<T> {
    /// Starts at [`LOWEST`].
    pub fn new() -> Self {
        Self {
            fraction: convert(LOWEST),
            norm: None,
        }
    }

    /// ‖g_d‖ of one more sample, in any unit. Gives the cut-off for the next sample. A norm that
    /// is no number changes nothing.
    pub fn update(&mut self, norm: T) -> CutOff<T> {
        if norm.is_finite() {
            if let Some(before) = self.norm {
                let varies = (norm - before).abs() > norm * convert(THRESHOLD);
                let step: T = convert(if varies { STEP } else { -STEP });
                self.fraction = (self.fraction + step).clamp(convert(LOWEST), convert(HIGHEST));
            }
            self.norm = Some(norm);
        }
        self.cut_off()
    }

    /// As of the last sample.
    pub fn cut_off(&self) -> CutOff<T> {
        CutOff::new(self.fraction).unwrap_or(CutOff::of(LOWEST))
    }
}

impl<T: RealField + Copy> Default for AdaptiveCutOff<T> {
    fn default() -> Self {
        Self::new()
    }
}
