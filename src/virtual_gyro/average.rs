//! The sliding average (section 3.2.3) of the last n samples.

use super::fields::{Fields, NoAttitude};
use heapless::HistoryBuf;
use nalgebra::{RealField, Vector3, convert};

/// A window of N samples, at least one.
///
/// The delay of a steady change is (N − 1)/2 samples; the paper's N − 1 is only the time until the
/// window is full. The sum is formed anew each time: a running one would collect rounding.
#[derive(Clone, Debug)]
pub struct SlidingAverage<T: RealField + Copy, const N: usize> {
    window: HistoryBuf<Fields<T>, N>,
}

impl<T: RealField + Copy, const N: usize> SlidingAverage<T, N> {
    /// An empty window.
    pub fn new() -> Self {
        const { assert!(N > 0, "an average needs a sample") };
        Self {
            window: HistoryBuf::new(),
        }
    }

    /// One sample. None until the window is full.
    ///
    /// # Errors
    ///
    /// [`NoAttitude::NotFinite`]; the sample is left out.
    pub fn update(&mut self, sample: Fields<T>) -> Result<Option<Fields<T>>, NoAttitude> {
        Ok(self.take(sample.plausible()?))
    }

    /// The same of a sample that is known to be one.
    pub(super) fn take(&mut self, sample: Fields<T>) -> Option<Fields<T>> {
        self.window.write(sample);
        if !self.window.is_full() {
            return None;
        }
        let mean = |field: fn(&Fields<T>) -> Vector3<T>| {
            let sum = self.window.oldest_ordered().map(field);
            sum.fold(Vector3::zeros(), |sum, v| sum + v) / convert::<f64, T>(N as f64)
        };
        Some(Fields {
            gravity: mean(|sample| sample.gravity),
            magnetic: mean(|sample| sample.magnetic),
        })
    }
}

impl<T: RealField + Copy, const N: usize> Default for SlidingAverage<T, N> {
    fn default() -> Self {
        Self::new()
    }
}
