//! x-io Fusion, from the crate `fusion-ahrs`, alone and behind the gyro bias correction that comes
//! with it.
//!
//! Rates in °/s, single precision; of force and field only the direction is used.

use crate::{Orientation, Sample};
use fusion_ahrs::{Ahrs, AhrsSettings, Bias, BiasSettings, Convention, Vector};

pub fn plain_6(period_s: f64, samples: &[Sample]) -> Vec<Orientation> {
    run(period_s, samples, 6, None)
}

pub fn plain_9(period_s: f64, samples: &[Sample]) -> Vec<Orientation> {
    run(period_s, samples, 9, None)
}

pub fn bias_6(period_s: f64, samples: &[Sample]) -> Vec<Orientation> {
    run(period_s, samples, 6, Some(bias(period_s)))
}

pub fn bias_9(period_s: f64, samples: &[Sample]) -> Vec<Orientation> {
    run(period_s, samples, 9, Some(bias(period_s)))
}

fn bias(period_s: f64) -> Bias {
    Bias::with_settings(BiasSettings {
        sample_rate: period_s.recip() as f32,
        ..Default::default()
    })
}

fn run(period_s: f64, samples: &[Sample], axes: u8, mut bias: Option<Bias>) -> Vec<Orientation> {
    let mut filter = Ahrs::with_settings(AhrsSettings {
        sample_rate: period_s.recip() as f32,
        convention: Convention::Enu,
        ..Default::default()
    });
    let step = |sample: &Sample| {
        let mut rate = vector(sample.rate.map(f64::to_degrees));
        if let Some(bias) = &mut bias {
            rate = bias.update(rate);
        }
        let force = vector(sample.force);
        match axes {
            6 => filter.update_no_magnetometer(rate, force),
            _ => filter.update(rate, force, vector(sample.field)),
        }
        let q = filter.quaternion();
        [q.w, q.x, q.y, q.z].map(f64::from)
    };
    samples.iter().map(step).collect()
}

fn vector([x, y, z]: [f64; 3]) -> Vector {
    Vector::new(x as f32, y as f32, z as f32)
}
