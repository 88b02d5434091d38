//! Which pitch is right? The slide “Example: Pitch” of the 2016 lecture (003): pitch over time by the
//! gyro, by the accelerometer and by its complementary filter, beside the notes' quaternion filter
//! (000, eq. 24) and the truth.
//!
//! Run with `cargo run --example pitch_over_time -- RECORDING.imub`; without a recording a generated nod
//! is used. There, where one axis turns, expect the gyro to drift, the accelerometer to be noisy and both
//! filters to be better. Where axes turn together, the lecture's can be worse than the accelerometer.

#[path = "picture/mod.rs"]
mod picture;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use picture::{Line, Picture};
use std::error::Error;
use vrduino::calibration::GyroBias;
use vrduino::orientation::angles::pitch_half_circle;
use vrduino::orientation::complementary::Complementary;
use vrduino::orientation::euler::EulerAngles;
use vrduino::orientation::euler::lecture::{LectureComplementary, LectureDeadReckoning};
use vrduino::orientation::flatland::shortest_turn;
use vrduino::orientation::{TimeConstant, accelerometer};
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, Seconds, SpecificForce};
use vrduino_emulator::motion::{self, Imperfect, Imperfections, Motion, Turns};

const PERIOD: Seconds<f64> = Seconds(0.002);
const TIME_CONSTANT: Seconds<f64> = Seconds(1.0);
const LONGEST: f64 = 60.0; // of the motion (s)

/// Pitch alone, to and fro, felt by a shaken sensor.
fn nods() -> Box<dyn Motion> {
    println!("no recording named, so a generated motion:");
    let turns = (0..10).fold(Turns::new(1.0, 0.5), |turns, _| {
        let x = [1.0, 0.0, 0.0];
        turns.turn(x, 40.0, 1.0).turn(x, -40.0, 1.0)
    });
    let shaken = Imperfections {
        accel_noise: 1.0,
        ..Imperfections::default()
    };
    Box::new(Imperfect::new(Box::new(turns), shaken))
}

fn run() -> Result<(), Box<dyn Error>> {
    let motion = match std::env::args_os().nth(1) {
        Some(path) => motion::open(path.as_ref())?,
        None => nods(),
    };
    println!("{}", motion.describe());
    // A recorded sensor may lie in any way: level is how it lies at first.
    let at_first = SpecificForce::from_m_per_s2(Vector3::from(motion.at(0.0).force));
    let level = accelerometer::orientation(at_first).ok_or("the motion begins in free fall")?;
    let mut gyro = LectureDeadReckoning::new(PERIOD);
    let mut fused = LectureComplementary::new(TimeConstant::new(TIME_CONSTANT), PERIOD);
    let mut notes = Complementary::new(TimeConstant::new(TIME_CONSTANT), PERIOD);
    let mut lines = ["gyro", "accelerometer", "fused", "quaternion", "truth"].map(|name| Line {
        name,
        points: Vec::new(),
    });
    let (mut squares, mut compared) = ([0.0; 4], 0.0);
    let seconds = motion.duration().unwrap_or(LONGEST).min(LONGEST);
    for step in 0..(seconds / PERIOD.0) as u32 {
        let t = f64::from(step) * PERIOD.0;
        let now = motion.at(t);
        let reading = GyroBias::zero().correct(Sample {
            rate: AngularRate::from_rad_per_s(level * Vector3::from(now.rate)),
            force: SpecificForce::from_m_per_s2(level * Vector3::from(now.force)),
        });
        let pitches = [
            gyro.update(&reading).pitch,
            pitch_half_circle(reading.force()),
            fused.update(&reading).pitch,
            EulerAngles::of(notes.update(&reading)).pitch,
        ];
        let truth = now.truth.map(|[w, x, y, z]| {
            let body = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
            EulerAngles::of(body * level.inverse()).pitch
        });
        if let Some(truth) = truth {
            compared += 1.0;
            for (sum, pitch) in squares.iter_mut().zip(pitches) {
                *sum += shortest_turn(truth, pitch).degrees().powi(2);
            }
        }
        if step % 10 == 0 {
            let truth = truth.map_or(f64::NAN, |pitch| pitch.degrees());
            let drawn = pitches.map(|pitch| pitch.degrees()).into_iter();
            for (line, pitch) in lines.iter_mut().zip(drawn.chain([truth])) {
                line.points.push([t, pitch]);
            }
        }
    }
    if compared == 0.0 {
        return Err("the motion has no truth to compare with: give one that has".into());
    }
    println!(
        "its first {seconds:.1} s; time constant {} s",
        TIME_CONSTANT.0
    );
    println!("{:13} {:>10}", "", "rms error");
    for (line, square) in lines.iter().zip(squares) {
        println!("{:13} {:9.2}°", line.name, (square / compared).sqrt());
    }
    let picture = Picture {
        title: "Pitch over time (lecture, 2016)",
        x: "time (s)",
        y: "pitch (°)",
        lines: lines.into(),
    };
    println!("{}", picture.save("pitch_over_time")?.display());
    Ok(())
}

fn main() {
    if let Err(problem) = run() {
        eprintln!("error: {problem}");
        std::process::exit(1);
    }
}
