//! Which pitch is right? The slide “Example: Pitch” of the 2016 lecture (003): pitch over time by the
//! gyro, by the accelerometer and by its complementary filter, beside the notes' quaternion filter
//! (000, eq. 24) and the truth.
//!
//! Run with `cargo run --example pitch_over_time`, on a generated nod, or with a recording:
//! `cargo run --example pitch_over_time -- FILE` (.imub or .csv). Of the nod, where one axis turns,
//! expect what the lecture says: the gyro drifts, the accelerometer is noisy, and both filters are far
//! better than either. Where axes turn together, the lecture's can be worse than the accelerometer.

#[path = "motion/mod.rs"]
mod motion;

#[path = "picture/mod.rs"]
mod picture;

#[path = "program/mod.rs"]
mod program;

use motion::Chosen;
use nalgebra::{UnitQuaternion, Vector3};
use picture::{Line, Look, Picture, Scale, Stroke};
use std::error::Error;
use std::fmt::Write as _;
use std::process::ExitCode;
use vrduino::calibration::GyroBias;
use vrduino::orientation::angles::pitch_half_circle;
use vrduino::orientation::complementary::Complementary;
use vrduino::orientation::euler::EulerAngles;
use vrduino::orientation::euler::lecture::{LectureComplementary, LectureDeadReckoning};
use vrduino::orientation::flatland::shortest_turn;
use vrduino::orientation::{TimeConstant, accelerometer};
use vrduino::sensor::Sample;
use vrduino::units::{Angle, AngularRate, Seconds, SpecificForce};
use vrduino_emulator::motion::{Imperfect, Imperfections, Turns};

const PERIOD: Seconds<f64> = Seconds(0.002);
const TIME_CONSTANT: Seconds<f64> = Seconds(1.0);
const LONGEST: f64 = 60.0; // of the motion (s)
/// The truth beneath, what is noisy above it, and the filters on top.
const LINES: [(&str, Stroke); 5] = [
    ("truth", Stroke::Broad),
    ("accelerometer", Stroke::Fine),
    ("gyro", Stroke::Plain),
    ("lecture's filter", Stroke::Plain),
    ("quaternion filter", Stroke::Dashed),
];

/// Pitch alone, to and fro, felt by a shaken sensor.
fn nods() -> Imperfect {
    let turns = (0..10).fold(Turns::new(1.0, 0.5), |turns, _| {
        let x = [1.0, 0.0, 0.0];
        turns.turn(x, 40.0, 1.0).turn(x, -40.0, 1.0)
    });
    let shaken = Imperfections {
        accel_noise: 1.0,
        ..Imperfections::default()
    };
    Imperfect::new(Box::new(turns), shaken)
}

/// From the body's axes to those that are level at first: a recorded sensor may lie in any way. By
/// the truth where it is known, for one sample of a shaken sensor is degrees off; else by the mean
/// force of the first second, in which motions rest.
fn level(motion: &Chosen) -> Option<UnitQuaternion<f64>> {
    let instants = (0..500).map(|step| motion.at(f64::from(step) * PERIOD.0));
    let mean: Vector3<f64> = instants.map(|instant| Vector3::from(instant.force)).sum();
    let truth = motion::truth(&motion.at(0.0));
    let up = truth.map_or(mean, |truth| truth.inverse() * Vector3::y());
    accelerometer::orientation(SpecificForce::from_m_per_s2(up))
}

fn main() -> ExitCode {
    program::run(include_str!("pitch_over_time.rs"), 1, run)
}

fn run(text: &mut String) -> Result<(), Box<dyn Error>> {
    let motion = motion::chosen("a generated nod", nods())?
        .lasting(1.0)?
        .with_truth()?;
    let level = level(&motion).ok_or("the motion begins in free fall: cut that off")?;
    let mut gyro = LectureDeadReckoning::new(PERIOD);
    let mut fused = LectureComplementary::new(TimeConstant::new(TIME_CONSTANT), PERIOD);
    let mut notes = Complementary::new(TimeConstant::new(TIME_CONSTANT), PERIOD);
    let mut lines = LINES.map(|(name, _)| Line {
        name,
        points: Vec::new(),
    });
    let (mut squares, mut compared) = ([0.0; 4], 0.0);
    let seconds = motion.seconds.min(LONGEST);
    for step in 0..(seconds / PERIOD.0) as u32 {
        let t = f64::from(step) * PERIOD.0;
        let now = motion.at(t);
        let reading = GyroBias::zero().correct(Sample {
            rate: AngularRate::from_rad_per_s(level * Vector3::from(now.rate)),
            force: SpecificForce::from_m_per_s2(level * Vector3::from(now.force)),
        });
        let pitches = [
            pitch_half_circle(reading.force()),
            gyro.update(&reading).pitch,
            fused.update(&reading).pitch,
            EulerAngles::of(notes.update(&reading)).pitch,
        ];
        let truth = motion::truth(&now).map(|body| EulerAngles::of(body * level.inverse()).pitch);
        if let Some(truth) = truth {
            compared += 1.0;
            for (sum, pitch) in squares.iter_mut().zip(pitches) {
                *sum += shortest_turn(truth, pitch).degrees().powi(2);
            }
        }
        if step % 10 == 0 {
            let truth = truth.map_or(f64::NAN, Angle::degrees);
            let drawn = [truth].into_iter().chain(pitches.map(Angle::degrees));
            for (line, pitch) in lines.iter_mut().zip(drawn) {
                line.points.push([t, pitch]);
            }
        }
    }
    if compared == 0.0 {
        return Err(format!("there is no true orientation in the first {seconds} s").into());
    }
    writeln!(text, "{}", motion.describe())?;
    let constant = TIME_CONSTANT.0;
    writeln!(text, "its first {seconds:.1} s; time constant {constant} s")?;
    writeln!(text, "{:17} {:>10}", "pitch by", "rms error")?;
    for ((name, _), square) in LINES.iter().skip(1).zip(squares) {
        writeln!(text, "{name:17} {:9.2}°", f64::sqrt(square / compared))?;
    }
    let look = Look {
        scales: [Scale::Even; 2],
        strokes: &LINES.map(|(_, stroke)| stroke),
    };
    let picture = Picture {
        title: &format!("Pitch over time (2016 lecture): {}", motion.name),
        x: "time (s)",
        y: "pitch (°)",
        lines: lines.into(),
    };
    Ok(writeln!(
        text,
        "{}",
        picture.save_with("pitch_over_time", &look)?.display()
    )?)
}
