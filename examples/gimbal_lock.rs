//! What is wrong with three angles? The Euler complementary filter of the 2016 lecture (003, “Tilt
//! Correction with Complementary Filtering”) beside the quaternion filter of the notes (000, eq. 24).
//!
//! Run with `cargo run --example gimbal_lock`. Sensors are perfect and the motions scripted, so every
//! error is the method's. Expect both to be right while a single axis turns and pitch stays below 90°;
//! past it (gimbal lock), or when axes turn together, only the quaternion filter is. Of the same turns
//! the lecture's dead reckoning, without the accelerometer, makes other errors: 120° where the filter
//! makes 90°, and 3.5° where it makes 3.6° (`docs/errata.md`, 003).

#[path = "picture/mod.rs"]
mod picture;

#[path = "program/mod.rs"]
mod program;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use picture::{Line, Picture};
use std::error::Error;
use std::fmt::Write as _;
use std::process::ExitCode;
use vrduino::calibration::GyroBias;
use vrduino::orientation::TimeConstant;
use vrduino::orientation::complementary::Complementary;
use vrduino::orientation::euler::lecture::LectureComplementary;
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, Seconds, SpecificForce};
use vrduino_emulator::motion::{Motion, Turns};

const PERIOD: Seconds<f64> = Seconds(0.001);
const ALPHA: f64 = 0.99;
const X: [f64; 3] = [1.0, 0.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// The errors (°) of the lecture's filter and of the quaternion filter over time.
fn errors(motion: &dyn Motion) -> [Vec<[f64; 2]>; 2] {
    let weight = TimeConstant::from_gyro_weight(ALPHA, PERIOD);
    let mut lecture = LectureComplementary::new(weight, PERIOD);
    let mut notes = Complementary::new(weight, PERIOD);
    let mut errors = [Vec::new(), Vec::new()];
    let steps = (motion.duration().unwrap_or_default() / PERIOD.0).round() as u32;
    for step in 1..=steps {
        let t = f64::from(step) * PERIOD.0;
        let now = motion.at(t);
        let Some([w, x, y, z]) = now.truth else {
            continue;
        };
        let truth = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let reading = GyroBias::zero().correct(Sample {
            // In the middle of the step, where it stands for the whole of it.
            rate: AngularRate::from_rad_per_s(Vector3::from(motion.at(t - PERIOD.0 / 2.0).rate)),
            force: SpecificForce::from_m_per_s2(Vector3::from(now.force)),
        });
        let found = [
            lecture.update(&reading).orientation(),
            notes.update(&reading),
        ];
        for (errors, found) in errors.iter_mut().zip(found) {
            errors.push([t, truth.angle_to(&found).to_degrees()]);
        }
    }
    errors
}

fn main() -> ExitCode {
    program::run(include_str!("gimbal_lock.rs"), 0, run)
}

fn run(text: &mut String) -> Result<(), Box<dyn Error>> {
    let start = || Turns::new(0.5, 0.5);
    let over = start().turn(X, 150.0, 2.5);
    let motions = [
        ("pitch to 80°", start().turn(X, 80.0, 1.5)),
        ("pitch past 90° to 150°", over.clone()),
        (
            "roll by 10°, then nod by 20°",
            start().turn(Z, 10.0, 0.5).turn(X, 20.0, 0.3),
        ),
        (
            "roll by 90°, then a quarter turn",
            start().turn(Z, 90.0, 1.5).turn(X, 90.0, 1.5),
        ),
        (
            "x and z together by 100°",
            start().turn([1.0, 0.0, 1.0], 100.0, 1.5),
        ),
    ];
    writeln!(
        text,
        "{:33} {:>17} {:>17}",
        "worst error", "Euler", "quaternion"
    )?;
    for (name, motion) in &motions {
        let [euler, quaternion] = errors(motion).map(|errors| {
            let worst = errors.iter().map(|point| point[1]).reduce(f64::max);
            worst.unwrap_or(f64::NAN)
        });
        writeln!(text, "{name:33} {euler:16.4}° {quaternion:16.4}°")?;
    }
    let [euler, quaternion] = errors(&over);
    let picture = Picture {
        title: "Error of both filters while pitch goes past 90°: gimbal lock",
        x: "time (s)",
        y: "error (°)",
        lines: vec![
            Line {
                name: "Euler filter (2016 lecture)",
                points: euler,
            },
            Line {
                name: "quaternion filter (notes)",
                points: quaternion,
            },
        ],
    };
    Ok(writeln!(
        text,
        "{}",
        picture.save("gimbal_lock")?.display()
    )?)
}
