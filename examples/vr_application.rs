//! How does a host make a camera of six raw values? The application of the gyroscope-emulation
//! paper (section 5.3, figure 9): the board sends the counts of accelerometer and magnetometer as
//! they are, the host does the rest by the method of section 4 and turns a camera.
//!
//! Run with `cargo run --example vr_application`, or behind it `-- RECORDING.imub`. Expect the three
//! angles once in two seconds, and a camera that follows the truth by some degrees, a little late.

use std::process::ExitCode;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use vrduino::frames::axes::Axes;
use vrduino::imu::RANGES;
use vrduino::sensor::magnetometer::{RawField, Resolution, SensitivityAdjustment, to_body};
use vrduino::sensor::{RawSample, Sample};
use vrduino::units::{AngularRate, MagneticField, Seconds, SpecificForce};
use vrduino::virtual_gyro::{Estimate, Method, Settings, VirtualGyro};
use vrduino_emulator::motion::{self, Head, Instant, Motion, MotionError};

#[path = "picture/mod.rs"]
mod picture;
use picture::{Line, Picture};

/// Lines a second.
const RATE: f64 = 100.0;

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
    let count = (motion.duration().unwrap_or(30.0) * RATE) as u32;
    let mut gyro = VirtualGyro::<f64, 5, 5>::new(Settings {
        sample_period: Seconds(1.0 / RATE),
        method: Method::Matrix,
    });
    let mut angles: [Vec<[f64; 2]>; 3] = Default::default();
    let (mut squares, mut compared) = (0.0, 0);
    println!(
        "time (s)   six raw values                          roll   pitch     yaw (°)   off (°)"
    );
    for k in 0..count {
        let t = f64::from(k) / RATE;
        let instant = motion.at(t);
        let line = board(&instant);
        let Some(estimate) = host(&mut gyro, &line)? else {
            continue;
        };
        let found = [
            estimate.angles.roll,
            estimate.angles.pitch,
            estimate.angles.yaw,
        ];
        let found = found.map(|angle| angle.degrees());
        for (points, degrees) in angles.iter_mut().zip(found) {
            points.push([t, degrees]);
        }
        // What a renderer with y up takes for its camera.
        let camera = Axes::NorthEastDown.orientation_to_y_up(estimate.orientation);
        let off = instant.truth.map(|[w, x, y, z]| {
            let truth = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
            camera.angle_to(&truth).to_degrees()
        });
        if let Some(off) = off {
            squares += off * off;
            compared += 1;
        }
        if k % 200 == 0 {
            let [roll, pitch, yaw] = found;
            let off = off.map_or("-".into(), |off| format!("{off:.1}"));
            println!("{t:8.2}   {line:36} {roll:7.1} {pitch:7.1} {yaw:7.1} {off:>13}");
        }
    }
    if angles[0].is_empty() {
        return Err("no orientation: the motion is too short or has no magnetic field".into());
    }
    println!(
        "camera off by {:.2}° rms over {compared} lines",
        (squares / f64::from(compared)).sqrt()
    );
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
    let [ax, ay, az] = RANGES
        .counts(&Sample {
            rate: AngularRate::zero(),
            force: SpecificForce::from_m_per_s2(Vector3::from(instant.force)),
        })
        .accel;
    let own = to_body(Vector3::from(instant.magnetic_field()));
    let counts = own / Resolution::Bits16.microtesla_per_count();
    let [mx, my, mz] = counts.map(|count| count.round() as i16).into();
    format!("{ax} {ay} {az} {mx} {my} {mz}")
}

/// What the host makes of a line. None while the filters fill, and where nothing tells an attitude.
fn host(
    gyro: &mut VirtualGyro<f64, 5, 5>,
    line: &str,
) -> Result<Option<Estimate<f64>>, Box<dyn std::error::Error>> {
    let numbers = line
        .split(' ')
        .map(str::parse)
        .collect::<Result<Vec<i16>, _>>()?;
    let [ax, ay, az, mx, my, mz] = numbers[..] else {
        return Err(format!("{line:?} is not six numbers").into());
    };
    let raw = RawSample {
        accel: [ax, ay, az],
        ..RawSample::default()
    };
    let raw_field = RawField {
        counts: [mx, my, mz],
        resolution: Resolution::Bits16,
        overflow: false,
    };
    let force = RANGES.sample::<f64>(&raw).force.m_per_s2();
    let field = raw_field
        .field::<f64>(SensitivityAdjustment::NONE)?
        .microtesla();
    let paper = |v| Axes::NorthEastDown.from_y_up(v);
    let force = SpecificForce::from_m_per_s2(paper(force));
    let field = MagneticField::from_microtesla(paper(field));
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
