//! What does the accelerometer alone know of an orientation? Figure 7 of the course notes (sections
//! 5.2 and 5.3): the accelerometer only on the left, the complementary filter on the right.
//!
//! Run with `cargo run --example accelerometer_only`, or behind it `-- RECORDING.imub`. Expect the
//! accelerometer alone to be off in heading by whatever the head has turned, and to take each of its
//! accelerations for a tilt; the filter is off by little in both.

use std::process::ExitCode;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use vrduino::calibration::GyroBias;
use vrduino::orientation::complementary::Complementary;
use vrduino::orientation::{DEFAULT_TIME_CONSTANT, TimeConstant, accelerometer};
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, Seconds, SpecificForce};
use vrduino_emulator::motion::{self, Head, Imperfect, Imperfections, Motion, MotionError};

#[path = "picture/mod.rs"]
mod picture;
use picture::{Line, Picture};

const PERIOD: f64 = 0.005;
/// Samples at the beginning that are taken to be at rest, for the gyro's bias: two seconds.
const REST: u32 = 400;
const NAMES: [&str; 4] = [
    "alone: heading",
    "alone: tilt",
    "fused: heading",
    "fused: tilt",
];

fn main() -> ExitCode {
    if let Err(error) = run() {
        eprintln!("error: {error}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let motion = motion()?;
    println!("{}", motion.describe());
    let at = |index: u32| motion.at(f64::from(index) * PERIOD);
    let count = (motion.duration().unwrap_or(60.0) / PERIOD) as u32;
    let rates = (0..REST).map(|index| Vector3::from(at(index).rate));
    let mean = rates.sum::<Vector3<f64>>() / f64::from(REST);
    let bias = GyroBias::new(AngularRate::from_rad_per_s(mean));

    let constant = TimeConstant::new(Seconds(DEFAULT_TIME_CONSTANT.time().0.into()));
    let mut filter = Complementary::new(constant, Seconds(PERIOD));
    filter.reset(SpecificForce::from_m_per_s2(at(REST).force.into()));
    // Neither knows where north is: both are told so at the first true orientation.
    let mut north = None;
    let mut errors: [Vec<[f64; 2]>; 4] = Default::default();
    for index in REST..count {
        let instant = at(index);
        let reading = bias.correct(Sample {
            rate: AngularRate::from_rad_per_s(instant.rate.into()),
            force: SpecificForce::from_m_per_s2(instant.force.into()),
        });
        let fused = filter.update(&reading);
        let alone = accelerometer::orientation(reading.force());
        let (Some([w, x, y, z]), Some(alone)) = (instant.truth, alone) else {
            continue;
        };
        let truth = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
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
        return Err("the motion is too short or has no true orientation to compare with".into());
    }

    println!("error in degrees       rms   largest");
    for (name, points) in NAMES.iter().zip(&errors) {
        let sum: f64 = points.iter().map(|[_, error]| error * error).sum();
        let largest = points.iter().fold(0.0_f64, |most, [_, e]| most.max(*e));
        let rms = (sum / points.len() as f64).sqrt();
        println!("{name:16} {rms:9.2} {largest:9.2}");
    }
    // Ten points a second are enough to look at.
    let thinned = errors.map(|points| points.into_iter().step_by(20).collect());
    let lines = NAMES.into_iter().zip(thinned);
    let picture = Picture {
        title: "Accelerometer alone, and fused with the gyro",
        x: "time (s)",
        y: "error (°)",
        lines: lines.map(|(name, points)| Line { name, points }).collect(),
    };
    println!("{}", picture.save("accelerometer_only")?.display());
    Ok(())
}

/// The recording named on the command line, or else a head on its neck.
fn motion() -> Result<Box<dyn Motion>, MotionError> {
    if let Some(path) = std::env::args_os().nth(1) {
        return motion::open(path.as_ref());
    }
    let lever_arm = Head::ON_THE_NECK;
    let head = Imperfect::new(Box::new(Head { lever_arm }), Imperfections::default());
    Ok(Box::new(head))
}

/// The part of a turn that is about the vertical.
fn turn_about_up(q: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 2.0 * q.j.atan2(q.w))
}
