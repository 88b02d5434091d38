//! What samples say of themselves, in words.

use vrduino::wire::Status;
use vrduino::wire::provenance::Compass;

/// The latest sample's status, and how often since it was last looked at what lasts for a sample only.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Condition {
    /// None before the first sample.
    latest: Option<Option<Status>>,
    clipped: u64,
    repeated: u64,
    skipped: u64,
}

impl Condition {
    /// Takes the status of a sample; the course's lines have none.
    pub fn take(&mut self, status: Option<Status>) {
        self.latest = Some(status);
        if let Some(status) = status {
            self.clipped += u64::from(status.clipped);
            self.repeated += u64::from(status.repeated);
            self.skipped += u64::from(status.skipped);
        }
    }

    /// The latest.
    pub fn latest(&self) -> Option<Status> {
        self.latest.flatten()
    }

    /// Samples at the end of the sensor's range.
    pub fn clipped(&self) -> u64 {
        self.clipped
    }

    /// Samples that the sensor had not renewed.
    pub fn repeated(&self) -> u64 {
        self.repeated
    }

    /// Samples before which some were left out.
    pub fn skipped(&self) -> u64 {
        self.skipped
    }

    /// This, and what was counted before it.
    pub fn with(&self, earlier: &Self) -> Self {
        Self {
            latest: self.latest.or(earlier.latest),
            clipped: self.clipped + earlier.clipped,
            repeated: self.repeated + earlier.repeated,
            skipped: self.skipped + earlier.skipped,
        }
    }

    /// The counts begin anew.
    pub fn forget(&mut self) {
        *self = Self {
            latest: self.latest,
            ..Self::default()
        };
    }

    /// In words, a fact each, what wants attention first.
    pub fn words(&self) -> Vec<&'static str> {
        let status = match self.latest {
            None => return vec!["no orientation yet"],
            Some(None) => return vec!["no status in this stream"],
            Some(Some(status)) => status,
        };
        let mut words = Vec::new();
        if self.clipped > 0 {
            words.push("clipped");
        }
        if self.repeated > 0 {
            words.push("samples repeated");
        }
        if self.skipped > 0 {
            words.push("samples left out");
        }
        // The notes' estimator does not look whether it rests.
        if status.notes {
            words.push("notes' filter");
        } else {
            words.push(if status.still { "still" } else { "moving" });
        }
        words.push(if status.bias_measured {
            "bias measured"
        } else {
            "bias unknown"
        });
        words.push(match status.compass {
            Compass::Absent => "no compass",
            Compass::Unused => "compass not followed",
            Compass::Followed => "heading by compass",
            Compass::Disturbed => "compass disturbed",
        });
        words
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lasts_for_a_sample_is_told_until_it_was_looked_at() {
        let mut condition = Condition::default();
        assert_eq!(condition.words(), ["no orientation yet"]);
        condition.take(None);
        assert_eq!(condition.words(), ["no status in this stream"]);
        let clipped = Status {
            clipped: true,
            compass: Compass::Followed,
            ..Status::default()
        };
        condition.take(Some(clipped));
        condition.take(Some(Status {
            still: true,
            bias_measured: true,
            ..Status::default()
        }));
        assert_eq!(
            condition.words(),
            ["clipped", "still", "bias measured", "no compass"]
        );
        condition.forget();
        assert_eq!(condition.words(), ["still", "bias measured", "no compass"]);
    }
}
