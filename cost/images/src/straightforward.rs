//! The course's filter as it is written with nalgebra, in single precision.

use crate::filter::{BIAS_DPS, Counts, Filter, PERIOD_S};
use nalgebra::{Unit, UnitQuaternion, Vector3};

/// 1 − α of eq. 24, of a time constant of 7.6 s.
const ACCELEROMETER_WEIGHT: f32 = (PERIOD_S / (7.6 + PERIOD_S)) as f32;

/// By unit quaternions.
pub struct Straightforward {
    q: UnitQuaternion<f32>,
}

impl Filter for Straightforward {
    fn start() -> Self {
        Self {
            q: UnitQuaternion::identity(),
        }
    }

    #[inline]
    fn update(&mut self, counts: &Counts) {
        let vector = |counts: [i16; 3]| Vector3::from(counts.map(f32::from));
        let bias = Vector3::from(BIAS_DPS.map(|dps| dps as f32));
        let dps = vector(counts.sample.gyro) * (2000.0 / 32768.0) - bias;
        let force = vector(counts.sample.accel) * (2.0 / 32768.0);

        let rate = dps.map(f32::to_radians);
        self.q *= UnitQuaternion::from_scaled_axis(rate * PERIOD_S as f32);
        let up = self.q * force;
        let tilt = up.angle(&Vector3::y());
        if let Some(axis) = Unit::try_new(up.cross(&Vector3::y()), 1e-8) {
            let turn = UnitQuaternion::from_axis_angle(&axis, ACCELEROMETER_WEIGHT * tilt);
            self.q = turn * self.q;
        }
        self.q.renormalize();
    }

    fn orientation(&self) -> [f64; 4] {
        [self.q.w, self.q.i, self.q.j, self.q.k].map(f64::from)
    }
}
