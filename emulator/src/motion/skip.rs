//! Beginning in the middle of a motion.

use super::{Instant, Motion, MotionError};

/// A motion without its first seconds; made by [`skip`].
pub struct Skipped {
    motion: Box<dyn Motion>,
    start: f64,
}

/// The same motion from `seconds` after its beginning on.
///
/// # Errors
///
/// [`MotionError::Start`] if `seconds` is negative, not a number, or not before the motion's end.
pub fn skip(motion: Box<dyn Motion>, seconds: f64) -> Result<Box<dyn Motion>, MotionError> {
    let duration = motion.duration();
    if seconds == 0.0 {
        return Ok(motion);
    }
    let ends_before = duration.is_some_and(|duration| seconds >= duration);
    if !seconds.is_finite() || seconds < 0.0 || ends_before {
        return Err(MotionError::Start {
            start: seconds,
            duration,
        });
    }
    Ok(Box::new(Skipped {
        motion,
        start: seconds,
    }))
}

impl Motion for Skipped {
    fn at(&self, t: f64) -> Instant {
        self.motion.at(self.start + t.max(0.0))
    }

    fn duration(&self) -> Option<f64> {
        self.motion.duration().map(|duration| duration - self.start)
    }

    fn describe(&self) -> String {
        format!("{}, from {} s on", self.motion.describe(), self.start)
    }
}
