//! Bias, scale and cross-axis terms of the accelerometer, from a board laid on its six faces.
//!
//! At rest the specific force is 1 g long and points up, whatever the position; so six positions
//! with another axis up or down each tell what every axis makes of +1 g and of −1 g. That is the
//! six-position (tumble) test of inertial sensors (IEEE Std 1293; STMicroelectronics AN4508).
//!
//! # Which fit, and why
//!
//! The plain form of that test sets the six means against ±1 g along the axes. It believes that the
//! board stood exactly on its faces: a hand that is off by 1° adds 1.7 % to a cross-axis term, as
//! much as the data sheet allows the sensor itself (±2 %), and 0.07 m/s² to a bias. So here
//!
//! * **bias and scale** come from the *length* of the force alone, Σ kᵢ² (aᵢ − bᵢ)² = g², which no
//!   placing changes (I. Frosio, F. Pedersini, N. A. Borghese, “Autocalibration of MEMS
//!   accelerometers”, IEEE Transactions on Instrumentation and Measurement 58, 2009). Six unknowns,
//!   linear in the squares, least squares over all still seconds;
//! * **cross-axis terms** come from the directions, Mᵢⱼ = (aᵢ(j up) − aᵢ(j down)) / 2g, and only if
//!   asked for ([`CrossAxis::FromFaces`]). The half *sums* of the same readings must all be the bias:
//!   what they are off by is the placing error, as large in the half differences. It is measured,
//!   reported ([`Accelerometer::placing`]), and too large a one is refused.
//!
//! The half sums do not see a table out of level if the board is always turned over about an edge:
//! level the table to 0.1°, or lay each face down twice with half a turn in between. The cross-axis
//! terms also hold the angle between sensor and board, and so do the corrected axes.
//!
//! # How it goes
//!
//! Lay the board on each face, in any order, and leave it for two windows of
//! [`WINDOW`](super::WINDOW) samples. Positions are recognised by themselves; more windows refine.

use super::face::Face;
pub use super::face::{Face as Position, Faces};
use super::least_squares::{NormalEquations, number};
use super::{Stillness, Verdict};
use crate::sensor::measurement::Calibration;
use crate::sensor::{Ranges, RawSample};
use crate::units::{Angle, METRES_PER_S2_PER_G, SpecificForce};
use nalgebra::{Matrix3, RealField, SVector, Vector3, convert};

mod refusal;

pub use refusal::Refusal;

/// Still windows each face needs. With one of each, six unknowns would fit anything.
pub const WINDOWS_PER_FACE: u32 = 2;

/// Furthest from its face that a position is taken, degrees. The sensor's own offset shows as up to 5.
const LARGEST_TILT_DEGREES: f64 = 15.0;

/// Furthest from 1 g that a still force may be, as a share. Data sheet: 60 to 80 mg of offset and 3 %.
const LARGEST_EXCESS: f64 = 0.25;

/// Largest rms of what the fit leaves, m/s². The means of a still second scatter by 0.002; a
/// cross-axis term of 2 % at 5° of tilt leaves 0.02.
const LARGEST_RESIDUAL: f64 = 0.05;

/// Largest error of scale believed, a share. Data sheet: ±3 % at 25 °C, ±0.026 %/°C.
const LARGEST_SCALE_ERROR: f64 = 0.06;

/// Largest bias believed, mg. Data sheet: ±60 (x, y) and ±80 (z) at 25 °C, ±1.5 mg/°C.
const LARGEST_BIAS_MG: f64 = 200.0;

/// Largest placing error at which cross-axis terms are taken, degrees: it leaves 0.5 % in each.
const LARGEST_PLACING_DEGREES: f64 = 0.4;

/// Largest change of temperature over the procedure, °C: the bias moves by 1.5 mg with each.
const LARGEST_WARMING: f32 = 10.0;

/// What becomes of a still or moving second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step<T> {
    /// It lay on this face, and so it did in so many windows now.
    Taken {
        /// The face.
        face: Face,
        /// Windows taken of it; [`WINDOWS_PER_FACE`] are enough.
        windows: u32,
    },
    /// It was still, but on no face. Nothing was taken.
    Tilted {
        /// The nearest face.
        nearest: Face,
        /// How far it is from that.
        tilt: Angle<T>,
    },
    /// It was still, but the force is far from 1 g or not finite: this is no board on a table.
    NotGravity,
    /// It moved. Nothing was taken.
    Moved,
}

/// Whether terms off the diagonal are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrossAxis {
    /// Taken as zero: right for a board placed by hand.
    Ignore,
    /// As the faces show them: for a board against a true block on a level table.
    FromFaces,
}

/// The accelerometer's faults, body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accelerometer<T: RealField + Copy> {
    /// What is subtracted first.
    pub bias: SpecificForce<T>,
    /// What the rest is multiplied by: diagonal, with [`CrossAxis::Ignore`].
    pub matrix: Matrix3<T>,
    /// Root mean square of the corrected force's length less 1 g, m/s².
    pub residual: T,
    /// How far the positions were off their faces, about each axis (one standard deviation).
    pub placing: Angle<T>,
    /// Mean temperature of the die, °C.
    pub temperature_celsius: f32,
}

impl<T: RealField + Copy> Accelerometer<T> {
    /// 001's form: A = matrix, b = −matrix · bias.
    pub fn calibration(&self) -> Calibration<SpecificForce<T>> {
        let offset = -(self.matrix * self.bias.m_per_s2());
        Calibration::new(self.matrix, SpecificForce::from_m_per_s2(offset))
    }
}

/// The procedure. Under 1 kB with single precision.
#[derive(Clone, Debug)]
pub struct SixPositions<T: RealField + Copy> {
    stillness: Stillness,
    faces: [Pile<T>; 6],
    /// Unknowns qₓ, q_y, q_z, lₓ, l_y, l_z in g: Σ qᵢ aᵢ² + lᵢ aᵢ = 1 − |a|².
    lengths: NormalEquations<T, 6>,
    moved: u32,
    temperature: Temperature,
}

/// All windows of a face.
#[derive(Clone, Copy, Debug)]
struct Pile<T: RealField + Copy> {
    sum: Vector3<T>,
    windows: u32,
}

#[derive(Clone, Copy, Debug)]
struct Temperature {
    sum: f32,
    coldest: f32,
    warmest: f32,
}

impl<T: RealField + Copy> SixPositions<T> {
    /// Nothing taken yet. `ranges` give the counts their meaning.
    pub fn new(ranges: Ranges) -> Self {
        let empty = Pile {
            sum: Vector3::zeros(),
            windows: 0,
        };
        Self {
            stillness: Stillness::new(ranges),
            faces: [empty; 6],
            lengths: NormalEquations::new(),
            moved: 0,
            temperature: Temperature {
                sum: 0.0,
                coldest: f32::INFINITY,
                warmest: f32::NEG_INFINITY,
            },
        }
    }

    /// Takes one sample. None while its window is not full.
    pub fn push(&mut self, raw: &RawSample) -> Option<Step<T>> {
        match self.stillness.push(raw) {
            Verdict::Collecting => None,
            Verdict::Moved => {
                self.moved = self.moved.saturating_add(1);
                Some(Step::Moved)
            }
            Verdict::Still(rest) => {
                let force = rest.force.m_per_s2().map(|a| convert::<f32, T>(a));
                let force = SpecificForce::from_m_per_s2(force);
                Some(self.place(force, rest.temperature_celsius))
            }
        }
    }

    /// Takes the mean of a window that is known to have been still (body frame), with the mean
    /// temperature of the die in °C.
    pub fn place(&mut self, force: SpecificForce<T>, temperature_celsius: f32) -> Step<T> {
        let g = force.g();
        // Written so that what is not a number is not gravity.
        let gravity = (g.norm() - T::one()).abs() <= convert(LARGEST_EXCESS);
        if !gravity || !temperature_celsius.is_finite() {
            return Step::NotGravity;
        }
        let (face, tilt) = Face::nearest(g);
        if tilt.degrees() > convert(LARGEST_TILT_DEGREES) {
            return Step::Tilted {
                nearest: face,
                tilt,
            };
        }
        let [x, y, z] = g.into();
        let row = SVector::from([x * x, y * y, z * z, x, y, z]);
        self.lengths.add(&row, T::one() - g.norm_squared());
        let pile = &mut self.faces[face as usize];
        pile.sum += force.m_per_s2();
        pile.windows = pile.windows.saturating_add(1);
        self.temperature.sum += temperature_celsius;
        self.temperature.coldest = self.temperature.coldest.min(temperature_celsius);
        self.temperature.warmest = self.temperature.warmest.max(temperature_celsius);
        Step::Taken {
            face,
            windows: pile.windows,
        }
    }

    /// The faces that have not lain still long enough yet.
    pub fn missing(&self) -> Faces {
        let mut missing = Faces::default();
        for face in Face::ALL {
            if self.faces[face as usize].windows < WINDOWS_PER_FACE {
                missing.insert(face);
            }
        }
        missing
    }

    /// The result, if all there is to check says that it is one.
    ///
    /// # Errors
    ///
    /// A [`Refusal`]: the first thing that is wrong, and what to do about it. Nothing is lost; more
    /// positions may mend it.
    pub fn result(&self, cross_axis: CrossAxis) -> Result<Accelerometer<T>, Refusal<T>> {
        if self.lengths.rows == 0 && self.moved > 0 {
            return Err(Refusal::NeverStill {
                windows: self.moved,
            });
        }
        let missing = self.missing();
        if !missing.is_empty() {
            return Err(Refusal::Missing(missing));
        }
        let warming = self.temperature.warmest - self.temperature.coldest;
        if warming > LARGEST_WARMING {
            return Err(Refusal::Warming(warming));
        }
        let (bias_g, scale, residual) = self.lengths().ok_or(Refusal::NoFit)?;
        for axis in 0..3 {
            let percent = (T::one() / scale[axis] - T::one()) * convert(100.0);
            if percent.abs() > convert(100.0 * LARGEST_SCALE_ERROR) {
                return Err(Refusal::Scale { axis, percent });
            }
        }
        let bias = SpecificForce::from_g(bias_g).m_per_s2();
        let largest_bias: T = convert(LARGEST_BIAS_MG / 1000.0);
        if let Some(axis) = (0..3).find(|&axis| bias_g[axis].abs() > largest_bias) {
            let m_per_s2 = bias[axis];
            return Err(Refusal::Bias { axis, m_per_s2 });
        }
        if residual > convert(LARGEST_RESIDUAL) {
            return Err(Refusal::Residual(residual));
        }
        let (mixing, placing) = self.directions(bias);
        let mut matrix = Matrix3::from_diagonal(&scale);
        if cross_axis == CrossAxis::FromFaces {
            if placing.degrees() > convert(LARGEST_PLACING_DEGREES) {
                return Err(Refusal::Placing(placing));
            }
            let mut mixing = mixing;
            mixing.set_diagonal(&scale.map(|scale| T::one() / scale));
            matrix = mixing.try_inverse().ok_or(Refusal::NoFit)?;
        }
        Ok(Accelerometer {
            bias: SpecificForce::from_m_per_s2(bias),
            matrix,
            residual,
            placing,
            temperature_celsius: self.temperature.sum / self.lengths.rows as f32,
        })
    }

    /// Bias in g, scale, and the rms of what is left in m/s².
    fn lengths(&self) -> Option<(Vector3<T>, Vector3<T>, T)> {
        let (solution, rms) = self.lengths.solve()?;
        let q = solution.fixed_rows::<3>(0).map(|q| q + T::one());
        let l = solution.fixed_rows::<3>(3);
        if q.min() <= T::zero() {
            return None;
        }
        let two: T = convert(2.0);
        // Σ qᵢ (aᵢ − bᵢ)² = 1 + Σ qᵢ bᵢ².
        let bias = -l.component_div(&(q * two));
        let whole = T::one() + q.dot(&bias.component_mul(&bias));
        let scale = (q / whole).map(|square| square.sqrt());
        // A length that is off by δ has a square that is off by 2δ.
        let residual = rms / (two * whole) * convert(METRES_PER_S2_PER_G);
        Some((bias, scale, residual))
    }

    /// M of eq. 3 from half differences, and the placing error from half sums.
    fn directions(&self, bias: Vector3<T>) -> (Matrix3<T>, Angle<T>) {
        let half: T = convert(0.5);
        let mean = |face: Face| {
            let pile = &self.faces[face as usize];
            pile.sum / number::<T>(i64::from(pile.windows.max(1)))
        };
        let mut mixing = Matrix3::identity();
        let mut squares = T::zero();
        for pair in Face::ALL.as_chunks::<2>().0 {
            let (up, axis) = (pair[0], pair[0].axis());
            let (above, below) = (mean(up), mean(pair[1]));
            mixing.set_column(axis, &((above - below) * half / up.force::<T>()[axis]));
            let mut off = (above + below) * half - bias;
            off[axis] = T::zero();
            squares += off.norm_squared();
        }
        // Six half sums, each √2 more certain than a single placing.
        let placing = (squares / convert(3.0)).sqrt() / convert(METRES_PER_S2_PER_G);
        (mixing, Angle::from_rad(placing))
    }
}
