//! The sliding median (section 3.2.2): of the last n samples, the one with the median norm of
//! gravity. Samples whose norm is an outlier never come out; in figure 4, though, the low-pass comes
//! before and makes a swell of each, which no window is long enough for.

use super::fields::{Fields, NoAttitude};
use core::cmp::Ordering;
use heapless::HistoryBuf;
use nalgebra::RealField;

/// A window of N samples, N odd.
///
/// The magnetic field that comes out is the one measured with the gravity that does. An even
/// window has no middle, and does not compile:
///
/// ```
/// let filter = vrduino::virtual_gyro::median::MedianByNorm::<f32, 5>::new();
/// ```
/// ```compile_fail
/// let filter = vrduino::virtual_gyro::median::MedianByNorm::<f32, 4>::new();
/// ```
///
/// The delay of a steady change is (N − 1)/2 samples. The paper's N − 1 is only the time until
/// the window is full.
#[derive(Clone, Debug)]
pub struct MedianByNorm<T: RealField + Copy, const N: usize> {
    window: HistoryBuf<Fields<T>, N>,
}

impl<T: RealField + Copy, const N: usize> MedianByNorm<T, N> {
    /// An empty window.
    pub fn new() -> Self {
        const { assert!(N % 2 == 1, "a median needs an odd number of samples") };
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
        let mut ranked = [(T::zero(), sample); N];
        for (place, sample) in ranked.iter_mut().zip(self.window.oldest_ordered()) {
            *place = (sample.gravity.norm(), *sample);
        }
        // Finite norms are in order: `plausible` lets no others in.
        ranked.sort_unstable_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(Ordering::Equal));
        ranked.get(N / 2).map(|&(_, sample)| sample)
    }
}

impl<T: RealField + Copy, const N: usize> Default for MedianByNorm<T, N> {
    fn default() -> Self {
        Self::new()
    }
}
