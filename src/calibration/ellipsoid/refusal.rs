//! Why a fit is not accepted, and what to do about it.

use super::{LARGEST_ERROR_PERCENT, STRONGEST, WEAKEST};
use crate::calibration::coverage::Coverage;
use crate::decimal::{Decimal, rounded};
use core::fmt;
use nalgebra::{RealField, convert};

/// Why there is no result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal<T: RealField + Copy> {
    /// The field was too strong for the sensor, or 500 µT from where it began, so many times.
    Magnet {
        /// Samples.
        samples: u32,
    },
    /// So many fields were no numbers, or counts that the sensor cannot report.
    Unreadable {
        /// Samples.
        samples: u32,
    },
    /// Too few samples in different directions.
    TooFew {
        /// Those that count.
        samples: u32,
        /// Those that are needed.
        needed: u32,
    },
    /// This axis (0, 1, 2) hardly changes, though the others do.
    DeadAxis {
        /// x, y, z.
        axis: usize,
    },
    /// All directions lie in one plane: the board was turned about one axis only.
    Flat,
    /// The points determine no ellipsoid.
    NoEllipsoid,
    /// Too little of the sphere was seen.
    Coverage(Coverage<T>),
    /// The field is not that of the earth, µT.
    Strength(T),
    /// The longest axis of the ellipsoid over its shortest.
    Lopsided(T),
    /// The corrected field's length varies by this much, per cent.
    Disturbed(T),
}

impl<T: RealField + Copy> fmt::Display for Refusal<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magnet { samples } => write!(
                f,
                "{samples} samples beside a magnet: move away from magnets and start again"
            ),
            Self::Unreadable { samples } => write!(
                f,
                "{samples} samples were no field: check the wiring or the file and start again"
            ),
            Self::TooFew { samples, needed } => write!(
                f,
                "{samples} samples count, {needed} needed: turn the board every way"
            ),
            Self::DeadAxis { axis } => {
                let axis = ["x", "y", "z"].get(*axis).copied().unwrap_or("?");
                write!(
                    f,
                    "{axis} does not change: turn the board about all axes, or the part is broken"
                )
            }
            Self::Flat => f.write_str("turned about one axis only: turn the board every way"),
            Self::NoEllipsoid => f.write_str(
                "no ellipsoid fits: move away from iron, and turn the board slowly every way",
            ),
            Self::Coverage(coverage) => {
                let axis = coverage.hole.iamax();
                let sign = if coverage.hole[axis] < T::zero() {
                    '-'
                } else {
                    '+'
                };
                write!(
                    f,
                    "{} % of all directions seen, largest hole {} degrees: turn the board until the field comes from {sign}{}",
                    rounded(coverage.share * convert(100.0), 0),
                    rounded(coverage.largest_hole.degrees(), 0),
                    ['x', 'y', 'z'][axis]
                )
            }
            Self::Strength(microtesla) => write!(
                f,
                "{} uT is not the earth's field ({} to {}): move away from iron, check the scale",
                rounded(*microtesla, 0),
                Decimal(WEAKEST as f32, 0),
                Decimal(STRONGEST as f32, 0)
            ),
            Self::Lopsided(ratio) => write!(
                f,
                "one axis reads {} times another: take iron off the board, or the part is broken",
                rounded(*ratio, 2)
            ),
            Self::Disturbed(percent) => write!(
                f,
                "field varies by {} %, {} allowed: turn the board on the spot, away from iron",
                rounded(*percent, 1),
                Decimal(LARGEST_ERROR_PERCENT as f32, 0)
            ),
        }
    }
}

impl<T: RealField + Copy> core::error::Error for Refusal<T> {}
