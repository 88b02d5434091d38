//! The metric of the benchmark: root mean square, over the samples in motion, of the angle of
//! e = q q_ref⁻¹ (world frame) and of its parts about the vertical and about the horizontal.

use std::f64::consts::PI;

use nalgebra::UnitQuaternion;

use crate::trial::Trial;

/// Errors of one run, in degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Score {
    /// How far from upright: what tilts the picture.
    pub inclination: f64,
    /// About the vertical. Of a filter without compass it begins anywhere.
    pub heading: f64,
    /// The whole angle.
    pub total: f64,
    /// The whole angle after the heading was set right once, just before the first motion.
    pub aligned: f64,
}

/// Samples before the first motion whose mean heading counts as the start.
const STILL: usize = 700;
/// Where none of those has a reference, so many of the first in motion.
const FIRST: usize = 50;

impl Score {
    /// Of orientations (body → world, y up), one after each sample of the trial.
    ///
    /// An orientation that is not finite makes every error infinite.
    ///
    /// # Panics
    ///
    /// If there are not as many orientations as samples.
    pub fn of(trial: &Trial, orientations: &[UnitQuaternion<f64>]) -> Self {
        assert_eq!(orientations.len(), trial.samples.len(), "{}", trial.name);
        let offset = start_heading(trial, orientations);
        let mut squares = [0.0; 4];
        let mut count = 0.0;
        for (index, truth) in trial.scored_references() {
            let e = error(&orientations[index], &truth);
            let parts = [
                inclination(e),
                heading(e),
                total(e),
                total(turned(e, -offset)),
            ];
            for (sum, part) in squares.iter_mut().zip(parts) {
                *sum += if part.is_finite() {
                    part * part
                } else {
                    f64::INFINITY
                };
            }
            count += 1.0;
        }
        let [inclination, heading, total, aligned] =
            squares.map(|sum: f64| (sum / count).sqrt().to_degrees());
        Self {
            inclination,
            heading,
            total,
            aligned,
        }
    }

    /// The mean of several, as the benchmark takes it over trials.
    pub fn mean(scores: &[Self]) -> Self {
        let mean =
            |part: fn(&Self) -> f64| scores.iter().map(part).sum::<f64>() / scores.len() as f64;
        Self {
            inclination: mean(|score| score.inclination),
            heading: mean(|score| score.heading),
            total: mean(|score| score.total),
            aligned: mean(|score| score.aligned),
        }
    }
}

/// e = q q_ref⁻¹ as w, x, y, z.
pub fn error(found: &UnitQuaternion<f64>, truth: &UnitQuaternion<f64>) -> [f64; 4] {
    let e = found * truth.inverse();
    [e.w, e.i, e.j, e.k]
}

/// Angle of e about a horizontal axis, rad.
pub fn inclination([w, _, y, _]: [f64; 4]) -> f64 {
    2.0 * w.hypot(y).min(1.0).acos()
}

/// Angle of e about the vertical, rad, from −π to π.
pub fn heading([w, _, y, _]: [f64; 4]) -> f64 {
    let angle = 2.0 * y.atan2(w);
    angle - 2.0 * PI * (angle / (2.0 * PI)).round()
}

/// Angle of e, rad.
pub fn total([w, ..]: [f64; 4]) -> f64 {
    2.0 * w.abs().min(1.0).acos()
}

/// e with another turn about the vertical after it.
fn turned([w, x, y, z]: [f64; 4], angle: f64) -> [f64; 4] {
    let (s, c) = (angle / 2.0).sin_cos();
    [c * w - s * y, c * x + s * z, c * y + s * w, c * z - s * x]
}

/// The mean error of heading while nothing moves yet, rad.
fn start_heading(trial: &Trial, orientations: &[UnitQuaternion<f64>]) -> f64 {
    let begin = trial.first_motion().unwrap_or(0);
    let still: Vec<_> = (begin.saturating_sub(STILL)..begin.max(1))
        .filter_map(|index| Some((index, trial.reference[index]?)))
        .collect();
    let chosen = if still.is_empty() {
        trial.scored_references().take(FIRST).collect()
    } else {
        still
    };
    let (mut sin, mut cos) = (0.0, 0.0);
    for (index, truth) in chosen {
        let angle = heading(error(&orientations[index], &truth));
        sin += angle.sin();
        cos += angle.cos();
    }
    sin.atan2(cos)
}
