//! Lines for what came as frames: from a board that streams nothing else, or a recording of one.

use vrduino::wire::orientation::{Decimals, Tag};
use vrduino::wire::{self, Q30};

use crate::stream::Sample;

/// Between two lines (s): what the course's pages keep up with, with room for what is early.
const BETWEEN: f64 = 9.5e-3;

/// Makes lines of frames, a hundred a second at most.
#[derive(Debug, Default)]
pub struct Frames {
    last: Option<f64>,
}

impl Frames {
    /// The course's line without its newline, if the sample came as a frame and it is time for one.
    pub fn take(&mut self, sample: &Sample) -> Option<String> {
        // No line says how far it is to be trusted.
        sample.status?;
        let is_early = self
            .last
            .is_some_and(|last| (0.0..BETWEEN).contains(&(sample.time - last)));
        if is_early && !sample.is_first {
            return None;
        }
        self.last = Some(sample.time);
        let q = Q30::from(&sample.orientation.cast());
        let line = wire::quaternion(Tag::Fused, q, Decimals::COURSE);
        Some(line.trim_end().to_owned())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};
    use vrduino::wire::Status;

    use super::{Frames, Sample};

    fn sample(milliseconds: u32) -> Sample {
        let quarter = UnitQuaternion::from_scaled_axis(Vector3::y() * std::f64::consts::FRAC_PI_2);
        Sample {
            time: f64::from(milliseconds) * 1e-3,
            arrival: 0.0,
            orientation: quarter,
            sequence: Some(0),
            status: Some(Status::default()),
            delay: None,
            is_first: false,
        }
    }

    #[test]
    fn one_in_ten_is_a_line_of_the_course() {
        let mut frames = Frames::default();
        let lines: Vec<_> = (0..1000).filter_map(|i| frames.take(&sample(i))).collect();
        assert_eq!(lines.len(), 100);
        assert!(
            lines
                .iter()
                .all(|line| line == "QC 0.707 0.000 0.707 0.000")
        );
    }

    #[test]
    fn a_new_beginning_does_not_wait_and_lines_stay_what_they_are() {
        let mut frames = Frames::default();
        assert!(frames.take(&sample(50_000)).is_some());
        assert!(frames.take(&sample(3)).is_some());
        let first = Sample {
            is_first: true,
            ..sample(4)
        };
        assert!(frames.take(&first).is_some());
        let line = Sample {
            status: None,
            ..sample(1000)
        };
        assert_eq!(frames.take(&line), None);
    }
}
