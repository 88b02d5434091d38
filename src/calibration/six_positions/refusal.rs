//! Why six positions are not accepted, and what to do about it.

use super::{Faces, LARGEST_PLACING_DEGREES, LARGEST_RESIDUAL};
use crate::decimal::{Decimal, rounded};
use crate::units::Angle;
use core::fmt;
use nalgebra::RealField;

/// Why there is no result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal<T> {
    /// No window was still, of this many.
    NeverStill {
        /// Windows that moved.
        windows: u32,
    },
    /// These faces have fewer than [`WINDOWS_PER_FACE`](super::WINDOWS_PER_FACE) windows.
    Missing(Faces),
    /// The temperature changed by this much, °C.
    Warming(f32),
    /// The readings do not fit any bias and scale.
    NoFit,
    /// The length of the corrected force still varies by this much (rms, m/s²).
    Residual(T),
    /// An axis (0, 1, 2) reads so many per cent too much or too little.
    Scale {
        /// x, y, z.
        axis: usize,
        /// Too much is positive.
        percent: T,
    },
    /// An axis (0, 1, 2) has so large a bias, m/s².
    Bias {
        /// x, y, z.
        axis: usize,
        /// As it would have been subtracted.
        m_per_s2: T,
    },
    /// Cross-axis terms were asked for, and the board was placed too badly for them.
    Placing(Angle<T>),
}

impl<T: RealField + Copy> fmt::Display for Refusal<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axis = |axis: &usize| ["x", "y", "z"].get(*axis).copied().unwrap_or("?");
        match self {
            Self::NeverStill { windows } => {
                write!(f, "moved in all {windows} windows: lay the board down and take the hand away")
            }
            Self::Missing(faces) => {
                write!(f, "not still long enough with {faces}: lay the board so for three seconds each")
            }
            Self::Warming(change) => {
                let change = Decimal(*change, 0);
                write!(f, "the sensor's temperature changed by {change} C: let it run ten minutes first")
            }
            Self::NoFit => f.write_str(
                "no bias and scale fit these forces: lay each face down again, on a table that stands",
            ),
            Self::Residual(rms) => {
                let (rms, most) = (rounded(*rms, 3), Decimal(LARGEST_RESIDUAL as f32, 2));
                write!(f, "{rms} m/s2 left over, more than {most}: repeat on a table that stands")
            }
            Self::Scale { axis: a, percent } => {
                let (a, percent) = (axis(a), rounded(*percent, 1));
                write!(f, "{a} reads {percent} % off, data sheet 3 %: check the range setting, or the part is broken")
            }
            Self::Bias { axis: a, m_per_s2 } => {
                let (a, m_per_s2) = (axis(a), rounded(*m_per_s2, 2));
                write!(f, "{a} is off by {m_per_s2} m/s2, data sheet 0.8: repeat, or the part is broken")
            }
            Self::Placing(angle) => {
                let degrees = rounded(angle.degrees(), 1);
                let most = Decimal(LARGEST_PLACING_DEGREES as f32, 1);
                write!(f, "placed {degrees} degrees off, {most} allowed: use a true block, or no cross-axis terms")
            }
        }
    }
}

impl<T: RealField + Copy> core::error::Error for Refusal<T> {}
