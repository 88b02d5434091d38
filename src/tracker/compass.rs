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
    last: Option<Result<MagneticField<f32>, FieldError>>,
    this_second: u32,
    last_second: u32,
    /// Since the last that was none.
    good: u32,
}

/// What has come, and whether to tell of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The field, body frame, or why it is none; nothing if nothing came.
    pub result: Option<Result<MagneticField<f32>, FieldError>>,
    /// Why it is none, when that begins.
    pub warning: Option<FieldError>,
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

    /// To be called with every sample of the IMU; mostly nothing has come.
    pub fn update(&mut self, raw: Option<RawField>) -> Measured {
        let (Some(raw), Some(adjustment)) = (raw, self.adjustment) else {
            return Measured {
                result: None,
                warning: None,
            };
        };
        let field = raw.field(adjustment);
        self.last = Some(field);
        self.this_second = self.this_second.saturating_add(1);
        let warning = match field {
            Ok(_) => {
                self.good = self.good.saturating_add(1);
                None
            }
            Err(error) => {
                let begins = self.good >= GOOD_AGAIN;
                self.good = 0;
                begins.then_some(error)
            }
        };
        Measured {
            result: Some(field),
            warning,
        }
    }

    /// A second is over.
    pub fn end_second(&mut self) {
        self.last_second = self.this_second;
        self.this_second = 0;
    }

    /// The last measurement, none if there was not one in the last second.
    pub fn last(&self) -> Option<Result<MagneticField<f32>, FieldError>> {
        self.last.filter(|_| self.last_second > 0)
    }

    /// Measurements in the last second.
    pub fn per_second(&self) -> u32 {
        self.last_second
    }
}
