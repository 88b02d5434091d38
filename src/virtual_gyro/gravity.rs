//! Extraction of gravity (section 3.2, figure 4): low-pass, then median, then average.

use super::average::SlidingAverage;
use super::butterworth::LowPass;
use super::cut_off::AdaptiveCutOff;
use super::fields::{Fields, NoAttitude};
use super::median::MedianByNorm;
use super::{butterworth::CutOff, cut_off};
use nalgebra::RealField;

/// The three filters in a row, for a median over MEDIAN samples (odd) and an average over MEAN.
///
/// The magnetic field goes through the same filters with the same coefficients and the same index
/// of the median. The paper delays it by a number of samples instead, which no number of samples
/// makes right: the delay of the low-pass depends on the frequency and on its cut-off.
#[derive(Clone, Debug)]
pub struct GravityExtraction<T: RealField + Copy, const MEDIAN: usize, const MEAN: usize> {
    low_pass: LowPass<T>,
    median: MedianByNorm<T, MEDIAN>,
    average: SlidingAverage<T, MEAN>,
    /// None: the cut-off stays as it was chosen.
    adaptive: Option<AdaptiveCutOff<T>>,
}

impl<T: RealField + Copy, const MEDIAN: usize, const MEAN: usize>
    GravityExtraction<T, MEDIAN, MEAN>
{
    /// With the adaptive cut-off of section 3.2.1, which follows a turn sooner than a fixed one and
    /// lets more of a shake through: to its rule both are changes of the norm.
    pub fn new() -> Self {
        Self {
            adaptive: Some(AdaptiveCutOff::new()),
            ..Self::with_cut_off(CutOff::of(cut_off::LOWEST))
        }
    }

    /// With a cut-off that stays.
    pub fn with_cut_off(cut_off: CutOff<T>) -> Self {
        Self {
            low_pass: LowPass::new(cut_off),
            median: MedianByNorm::new(),
            average: SlidingAverage::new(),
            adaptive: None,
        }
    }

    /// One sample of both sensors, g_d = −a. None until the windows are full, which takes
    /// MEDIAN + MEAN − 1 samples.
    ///
    /// # Errors
    ///
    /// [`NoAttitude::NotFinite`]; the sample is left out.
    pub fn update(&mut self, sample: Fields<T>) -> Result<Option<Fields<T>>, NoAttitude> {
        let smooth = self.low_pass.update(sample)?;
        let Some(median) = self.median.take(smooth) else {
            return Ok(None);
        };
        let Some(gravity) = self.average.take(median) else {
            return Ok(None);
        };
        if let Some(adaptive) = &mut self.adaptive {
            let before = adaptive.cut_off();
            let cut_off = adaptive.update(gravity.gravity.norm());
            if cut_off != before {
                self.low_pass.set_cut_off(cut_off);
            }
        }
        Ok(Some(gravity))
    }

    /// The cut-off the next sample meets, if it is the adaptive one.
    pub fn adaptive_cut_off(&self) -> Option<CutOff<T>> {
        self.adaptive.as_ref().map(AdaptiveCutOff::cut_off)
    }
}

impl<T: RealField + Copy, const MEDIAN: usize, const MEAN: usize> Default
    for GravityExtraction<T, MEDIAN, MEAN>
{
    fn default() -> Self {
        Self::new()
    }
}
