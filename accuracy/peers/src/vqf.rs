//! VQF, from the crate `vqf-rs`.
//!
//! The units and the world are ours already. One filter holds both answers; with 6 axes it is not
//! given the field.

use crate::{Orientation, Sample};
use vqf_rs::VQF;

pub fn run_6(period_s: f64, samples: &[Sample]) -> Vec<Orientation> {
    let mut filter = VQF::new(period_s, None, None, None);
    let step = |sample: &Sample| {
        filter.update(sample.rate, sample.force, None);
        components(filter.quat_6d())
    };
    samples.iter().map(step).collect()
}

pub fn run_9(period_s: f64, samples: &[Sample]) -> Vec<Orientation> {
    let mut filter = VQF::new(period_s, None, None, None);
    let step = |sample: &Sample| {
        filter.update(sample.rate, sample.force, Some(sample.field));
        components(filter.quat_9d())
    };
    samples.iter().map(step).collect()
}

fn components(vqf_rs::Quaternion(w, x, y, z): vqf_rs::Quaternion) -> Orientation {
    [w, x, y, z]
}
