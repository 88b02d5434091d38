//! What has been recorded so far.

use crate::stream::Sample;

/// What has been recorded so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Rows.
    pub samples: u64,
    /// Numbers between two samples that never came.
    pub missing: u64,
    /// Times the board or the connection began anew.
    pub restarts: u64,
    /// Arrivals of the first and the latest, in s on the source's clock.
    span: Option<(f64, f64)>,
    sequence: Option<u16>,
}

impl Tally {
    /// One more.
    pub fn count(&mut self, sample: &Sample) {
        if sample.is_first {
            self.restarts += u64::from(self.samples > 0);
        } else if let (Some(before), Some(now)) = (self.sequence, sample.sequence) {
            self.missing += u64::from(now.wrapping_sub(before).wrapping_sub(1));
        }
        self.samples += 1;
        self.sequence = sample.sequence;
        let (began, _) = self.span.unwrap_or((sample.arrival, sample.arrival));
        self.span = Some((began, sample.arrival));
    }

    /// How long it is, in s.
    pub fn seconds(&self) -> f64 {
        self.span.map_or(0.0, |(began, ended)| ended - began)
    }

    /// In words.
    pub fn describe(&self) -> String {
        let Self {
            samples, missing, ..
        } = self;
        let missing = match missing {
            0 => "none missing".into(),
            count => format!("{count} missing"),
        };
        let several = if *samples == 1 { "" } else { "s" };
        format!(
            "{samples} sample{several} in {:.1} s, {missing}",
            self.seconds()
        )
    }
}
