//! How does a host make a camera of six raw values? The application of the gyroscope-emulation
//! paper (section 5.3, figure 9): the board sends the counts of accelerometer and magnetometer as
//! they are, the host does the rest by the method of section 4 and turns a camera.
//!
//! Run with `cargo run --example vr_application`, or behind it `-- RECORDING.imub`. Expect the three
//! angles once in two seconds, and a camera some ten degrees (rms) off the truth.

use std::error::Error;
use std::process::ExitCode;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use vrduino::frames::axes::Axes;
use vrduino::imu::RANGES;
use vrduino::sensor::magnetometer::{RawField, Resolution, SensitivityAdjustment, to_body};
use vrduino::sensor::{RawSample, Sample};
use vrduino::units::{Angle, AngularRate, MagneticField, Seconds, SpecificForce};
use vrduino::virtual_gyro::{Estimate, Method, Settings, TaitBryan, VirtualGyro};
use vrduino_emulator::motion::{self, Head, Instant, Motion, MotionError};

#[path = "picture/mod.rs"]
mod picture;
use picture::{Line, Picture};

/// Lines a second.
const RATE: f64 = 100.0;

type Gyro = VirtualGyro<f64, 5, 5>;

fn main() -> ExitCode {
    if let Err(error) = run() {
        eprintln!("error: {error}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

fn run() -> Result<(), Box<dyn Error>> {
    let motion = motion()?;
    println!("{}", motion.describe());
    let count = (motion.duration().unwrap_or(30.0) * RATE) as u32;
    let mut gyro = Gyro::new(Settings {
        sample_period: Seconds(1.0 / RATE),
        method: Method::Matrix,
    });
    let mut angles: [Vec<[f64; 2]>; 3] = Default::default();
    let mut squares = Vec::new();
    println!(
        "time (s)   six raw values                          roll   pitch     yaw (°)   off (°)"
    );
    for k in 0..count {
        let t = f64::from(k) / RATE;
        let instant = motion.at(t);
        let line = board(&instant);
        let (Some(estimate), Some([w, x, y, z])) = (host(&mut gyro, &line)?, instant.truth) else {
            continue;
        };
        let TaitBryan { roll, pitch, yaw } = estimate.angles;
        let found = [roll, pitch, yaw].map(Angle::degrees);
        for (points, degrees) in angles.iter_mut().zip(found) {
            points.push([t, degrees]);
        }
        // What a renderer with y up takes for its camera.
        let camera = Axes::NorthEastDown.orientation_to_y_up(estimate.orientation);
        let truth = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let off = camera.angle_to(&truth).to_degrees();
        squares.push(off * off);
        if k % 200 == 0 {
            let [roll, pitch, yaw] = found;
            println!("{t:8.2}   {line:36} {roll:7.1} {pitch:7.1} {yaw:7.1} {off:13.1}");
        }
    }
    if squares.is_empty() {
        return Err("too short, without magnetic field or without true orientation".into());
    }
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    println!("camera off by {rms:.2}° rms over {} lines", squares.len());
    let lines = ["roll", "pitch", "yaw"].into_iter().zip(angles);
    let picture = Picture {
        title: "Six raw values in, three angles out",
        x: "time (s)",
        y: "angle (°)",
        lines: lines.map(|(name, points)| Line { name, points }).collect(),
    };
    println!("{}", picture.save("vr_application")?.display());
    Ok(())
}

/// What the board sends: counts of accelerometer and magnetometer, each along its own axes.
fn board(instant: &Instant) -> String {
    let (rate, force) = (AngularRate::zero(), Vector3::from(instant.force));
    let force = SpecificForce::from_m_per_s2(force);
    let [ax, ay, az] = RANGES.counts(&Sample { rate, force }).accel;
    let own = to_body(Vector3::from(instant.magnetic_field()));
    let counts = own / Resolution::Bits16.microtesla_per_count();
    let [mx, my, mz] = counts.map(|count| count.round() as i16).into();
    format!("{ax} {ay} {az} {mx} {my} {mz}")
}

/// What the host makes of a line. None while the filters fill, and where nothing tells an attitude.
fn host(gyro: &mut Gyro, line: &str) -> Result<Option<Estimate<f64>>, Box<dyn Error>> {
    let numbers: Result<Vec<i16>, _> = line.split(' ').map(str::parse).collect();
    let [ax, ay, az, mx, my, mz] = numbers?[..] else {
        return Err(format!("{line:?} is not six numbers").into());
    };
    let mut raw = RawSample::default();
    raw.accel.copy_from_slice(&[ax, ay, az]);
    let raw_field = RawField {
        counts: [mx, my, mz],
        resolution: Resolution::Bits16,
        overflow: false,
    };
    let force = RANGES.sample(&raw).force.m_per_s2();
    let field = raw_field.field(SensitivityAdjustment::NONE)?.microtesla();
    let [force, field] = [force, field].map(|v| Axes::NorthEastDown.from_y_up(v));
    let force = SpecificForce::from_m_per_s2(force);
    let field = MagneticField::from_microtesla(field);
    Ok(gyro.update(force, Some(field)).ok())
}

/// The recording named on the command line, or else a head on its neck.
fn motion() -> Result<Box<dyn Motion>, MotionError> {
    if let Some(path) = std::env::args_os().nth(1) {
        return motion::open(path.as_ref());
    }
    let lever_arm = Head::ON_THE_NECK;
    Ok(Box::new(Head { lever_arm }))
}
