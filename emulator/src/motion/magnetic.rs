//! The magnetic field around the sensor.

use super::Instant;
use super::rotation::{conjugate, rotate};

/// The Earth's field (µT) in the y-up world, whose −z axis is magnetic north.
///
/// Rounded figures for Stanford, where the course is taught: 48 µT, 61° below the horizon. Without
/// declination, as the recordings' worlds are aligned with magnetic north as well.
pub const EARTH: [f64; 3] = [
    0.0,
    -STRENGTH * 0.874_619_707_139_395_8,
    -STRENGTH * 0.484_809_620_246_337_06,
];

const STRENGTH: f64 = 48.0;

impl Instant {
    /// Magnetic flux density along the body axes (µT): as recorded; else the [Earth's](EARTH),
    /// turned into the body by the truth; else none, for where the sensor points is not known.
    pub fn magnetic_field(&self) -> [f64; 3] {
        match (self.field, self.truth) {
            (Some(field), _) => field,
            (None, Some(body_to_world)) => rotate(conjugate(body_to_world), EARTH),
            (None, None) => [0.0; 3],
        }
    }
}
