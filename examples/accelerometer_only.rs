//! What does the accelerometer alone know of an orientation? Figure 7 of the course notes (sections
//! 5.2 and 5.3): the accelerometer only on the left, the complementary filter on the right.
//!
//! Run with `cargo run --example accelerometer_only`, on a generated head, or with a recording:
//! `cargo run --example accelerometer_only -- FILE` (.imub or .csv). Expect the accelerometer alone to
//! be off in heading by whatever the head has turned, and to take each of its accelerations for a
//! tilt; the filter is off by little in both.

#[path = "motion/mod.rs"]
mod motion;

#[path = "picture/mod.rs"]
mod picture;

#[path = "program/mod.rs"]
mod program;

use std::error::Error;
use std::fmt::Write as _;
use std::process::ExitCode;

use nalgebra::{UnitQuaternion, Vector3};
use picture::{Line, Picture};
use vrduino::orientation::complementary::Complementary;
use vrduino::orientation::{DEFAULT_TIME_CONSTANT, TimeConstant, accelerometer};
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, Seconds, SpecificForce};
use vrduino_emulator::motion::{Head, Imperfect, Imperfections};

const PERIOD: f64 = 0.005;
/// Samples at the beginning that the bias is taken from: two seconds.
const REST: u32 = 400;
const NAMES: [&str; 4] = [
    "accelerometer alone: heading",
    "alone: tilt",
    "fused: heading",
    "fused: tilt",
];

fn main() -> ExitCode {
    program::run(include_str!("accelerometer_only.rs"), 1, run)
}

fn run(text: &mut String) -> Result<(), Box<dyn Error>> {
    let lever_arm = Head::ON_THE_NECK;
    let head = Imperfect::new(Box::new(Head { lever_arm }), Imperfections::default());
    let motion = motion::chosen("a generated head", head)?
        .lasting(f64::from(REST + 1) * PERIOD)?
        .with_truth()?;
    writeln!(text, "{}", motion.describe())?;
    let at = |index: u32| motion.at(f64::from(index) * PERIOD);
    let bias = motion.bias();

    let constant = TimeConstant::new(Seconds(DEFAULT_TIME_CONSTANT.time().0.into()));
    let mut filter = Complementary::new(constant, Seconds(PERIOD));
    filter.reset(SpecificForce::from_m_per_s2(at(REST).force.into()));
    // Neither knows where north is: both are told so at the first true orientation.
    let mut north = None;
    let mut errors: [Vec<[f64; 2]>; 4] = Default::default();
    for index in REST..(motion.seconds / PERIOD) as u32 {
        let instant = at(index);
        let reading = bias.correct(Sample {
            rate: AngularRate::from_rad_per_s(instant.rate.into()),
            force: SpecificForce::from_m_per_s2(instant.force.into()),
        });
        let fused = filter.update(&reading);
        let alone = accelerometer::orientation(reading.force());
        let (Some(truth), Some(alone)) = (motion::truth(&instant), alone) else {
            continue;
        };
        let north = *north.get_or_insert(turn_about_up(truth * fused.inverse()));
        for (which, found) in [alone, fused].into_iter().enumerate() {
            let error = truth * (north * found).inverse();
            let heading = turn_about_up(error).angle();
            let tilt = (error * Vector3::y()).angle(&Vector3::y());
            let t = f64::from(index) * PERIOD;
            errors[2 * which].push([t, heading.to_degrees()]);
            errors[2 * which + 1].push([t, tilt.to_degrees()]);
        }
    }
    if errors[0].is_empty() {
        return Err("there is no true orientation after the first two seconds".into());
    }

    writeln!(
        text,
        "{:28} {:>9} {:>9}",
        "error in degrees", "rms", "largest"
    )?;
    for (name, points) in NAMES.iter().zip(&errors) {
        let sum: f64 = points.iter().map(|[_, error]| error * error).sum();
        let largest = points.iter().fold(0.0_f64, |most, [_, e]| most.max(*e));
        let rms = (sum / points.len() as f64).sqrt();
        writeln!(text, "{name:28} {rms:9.2} {largest:9.2}")?;
    }
    // Ten points a second are enough to look at.
    let thinned = errors.map(|points| points.into_iter().step_by(20).collect());
    let lines = NAMES.into_iter().zip(thinned);
    let picture = Picture {
        title: &format!(
            "Accelerometer alone, and fused with the gyro: {}",
            motion.name
        ),
        x: "time (s)",
        y: "error (°)",
        lines: lines.map(|(name, points)| Line { name, points }).collect(),
    };
    Ok(writeln!(
        text,
        "{}",
        picture.save("accelerometer_only")?.display()
    )?)
}

/// The part of a turn that is about the vertical.
fn turn_about_up(q: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 2.0 * q.j.atan2(q.w))
}
