//! What comes from the magnetometer: counts to a field, and how many there were.

use crate::sensor::magnetometer::{FieldError, RawField, SensitivityAdjustment};
use crate::units::MagneticField;

/// Good fields, a second of them, after which one that is too strong is worth another warning.
const GOOD_AGAIN: u32 = 100;

/// The magnetometer's end of the tracker.
#[derive(Clone, Debug)]
pub struct Compass {
    /// None while there is no magnetometer.
    adjustment: Option<SensitivityAdjustment>,
    last: Option<RawField>,
    this_second: u32,
    last_second: u32,
    /// Since the last that was none.
    good: u32,
}

impl Compass {
    /// Without a magnetometer.
    pub fn none() -> Self {
        Self::of(None)
    }

    /// With this one.
    pub fn of(adjustment: Option<SensitivityAdjustment>) -> Self {
        Self {
            adjustment,
            last: None,
            this_second: 0,
            last_second: 0,
            good: GOOD_AGAIN,
        }
    }

    /// How sensitive its axes are; none while there is no magnetometer.
    pub fn adjustment(&self) -> Option<SensitivityAdjustment> {
        self.adjustment
    }

    /// A measurement has come. Why it is none, when that begins.
    pub fn update(&mut self, raw: RawField) -> Option<FieldError> {
        self.adjustment?;
        self.last = Some(raw);
        self.this_second = self.this_second.saturating_add(1);
        match raw.check() {
            Ok(()) => {
                self.good = self.good.saturating_add(1);
                None
            }
            Err(error) => {
                let begins = self.good >= GOOD_AGAIN;
                self.good = 0;
                begins.then_some(error)
            }
        }
    }

    /// A second is over.
    pub fn end_second(&mut self) {
        self.last_second = self.this_second;
        self.this_second = 0;
    }

    /// The last measurement, body frame, or why it is none; nothing without a magnetometer.
    pub fn last(&self) -> Option<Result<MagneticField<f32>, FieldError>> {
        Some(self.last?.field(self.adjustment?))
    }

    /// The same, if there was one in the last second.
    pub fn recent(&self) -> Option<Result<MagneticField<f32>, FieldError>> {
        self.last().filter(|_| self.last_second > 0)
    }

    /// Measurements in the last second.
    pub fn per_second(&self) -> u32 {
        self.last_second
    }
}
