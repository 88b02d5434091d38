//! Madgwick's and Mahony's filters of the crate `ahrs`.
//!
//! Rates in rad/s; of force and field only the direction is used. The world has x to magnetic north
//! and z up. The crate's `Default` holds gains *and* a period of 1/256 s, so the gains are repeated
//! here beside the period of the samples.

use crate::{Orientation, Sample};
use ahrs::{Ahrs, Madgwick, Mahony};
use nalgebra::{UnitQuaternion, Vector3};

/// Gain of `Madgwick::default()`.
const BETA: f64 = 0.1;
/// Gains of `Mahony::default()`: proportional, integral.
const KP: f64 = 0.5;
const KI: f64 = 0.0;

pub fn madgwick_6(period_s: f64, samples: &[Sample]) -> Vec<Orientation> {
    run_6(Madgwick::new(period_s, BETA), samples)
}

pub fn madgwick_9(period_s: f64, samples: &[Sample]) -> Vec<Orientation> {
    run_9(Madgwick::new(period_s, BETA), samples)
}

pub fn mahony_6(period_s: f64, samples: &[Sample]) -> Vec<Orientation> {
    run_6(Mahony::new(period_s, KP, KI), samples)
}

pub fn mahony_9(period_s: f64, samples: &[Sample]) -> Vec<Orientation> {
    run_9(Mahony::new(period_s, KP, KI), samples)
}

fn run_6(mut filter: impl Ahrs<f64>, samples: &[Sample]) -> Vec<Orientation> {
    let step = |sample: &Sample| {
        let rate = Vector3::from(sample.rate);
        let fused = filter.update_imu(&rate, &sample.force.into());
        let fused = fused.ok().copied();
        // A force of zero has no direction and is refused: the gyro goes on alone.
        enu(fused.unwrap_or_else(|| *filter.update_gyro(&rate)))
    };
    samples.iter().map(step).collect()
}

fn run_9(mut filter: impl Ahrs<f64>, samples: &[Sample]) -> Vec<Orientation> {
    let step = |sample: &Sample| {
        let rate = Vector3::from(sample.rate);
        let fused = filter.update(&rate, &sample.force.into(), &sample.field.into());
        let fused = fused.ok().copied();
        enu(fused.unwrap_or_else(|| *filter.update_gyro(&rate)))
    };
    samples.iter().map(step).collect()
}

/// From a world with x north, y west to one with x east, y north: a quarter turn about up.
fn enu(body_to_nwu: UnitQuaternion<f64>) -> Orientation {
    let quarter = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
    let q = quarter * body_to_nwu;
    [q.w, q.i, q.j, q.k]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gains_are_the_defaults_of_the_crate() {
        let period_s = 1.0 / 256.0;
        assert_eq!(Madgwick::new(period_s, BETA), Madgwick::default());
        assert_eq!(Mahony::new(period_s, KP, KI), Mahony::default());
    }
}
