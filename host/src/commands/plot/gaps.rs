//! Where samples are missing.

/// Bands at most; neighbours become one before there are more.
const BANDS: usize = 400;

/// Where samples are missing: bands of time (s).
#[derive(Clone, Debug, Default)]
pub struct Gaps {
    bands: Vec<(f64, f64)>,
    /// How near to each other two of them are one.
    tolerance: f64,
    count: u64,
}

impl Gaps {
    /// Between these two times there is nothing.
    pub fn push(&mut self, from: f64, to: f64) {
        self.count += 1;
        self.append((from, to));
        while self.bands.len() > BANDS {
            self.tolerance = (self.tolerance * 2.0).max(1e-3);
            for band in std::mem::take(&mut self.bands) {
                self.append(band);
            }
        }
    }

    fn append(&mut self, (from, to): (f64, f64)) {
        match self.bands.last_mut() {
            Some(before) if from - before.1 < self.tolerance => before.1 = to,
            _ => self.bands.push((from, to)),
        }
    }

    /// As they are drawn.
    pub fn bands(&self) -> &[(f64, f64)] {
        &self.bands
    }

    /// How many there were.
    pub fn count(&self) -> u64 {
        self.count
    }
}
