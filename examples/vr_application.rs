//! How does a host make a camera of six raw values? The application of the gyroscope-emulation
//! paper (section 5.3, figure 9): the board sends the counts of accelerometer and magnetometer as
//! they are, the host does the rest by the method of section 4 and turns a camera.
//!
//! Run with `cargo run --example vr_application`, on a generated head, or with a recording:
//! `cargo run --example vr_application -- FILE` (.imub or .csv). Expect the three angles once in two
//! seconds, and a camera that is some ten degrees (rms) off the truth while a head turns slowly, for
//! it comes late. On the BROAD recordings it is 8° to 21° off in slow motions, 28° to 38° in quick
//! turns, and of no use, up to 76°, where the device is carried about quickly or near a magnet.

#[path = "motion/mod.rs"]
mod motion;

#[path = "picture/mod.rs"]
mod picture;

#[path = "program/mod.rs"]
mod program;

use std::error::Error;
use std::fmt::Write as _;
use std::process::ExitCode;

use nalgebra::Vector3;
use picture::{Line, Look, Picture, Scale, Stroke};
use vrduino::frames::axes::Axes;
use vrduino::imu::RANGES;
use vrduino::sensor::magnetometer::{RawField, Resolution, SensitivityAdjustment, to_body};
use vrduino::sensor::{RawSample, Sample};
use vrduino::units::{Angle, AngularRate, MagneticField, Seconds, SpecificForce};
use vrduino::virtual_gyro::{
    Estimate, Method, Settings, TaitBryan, VirtualGyro, attitude_quaternion,
};
use vrduino_emulator::motion::{Head, Instant};

/// Lines a second.
const RATE: f64 = 100.0;
/// The true angles beneath those that were found.
const LINES: [(&str, Stroke); 6] = [
    ("truth of each", Stroke::Broad),
    ("", Stroke::Broad),
    ("", Stroke::Broad),
    ("roll", Stroke::Plain),
    ("pitch", Stroke::Plain),
    ("yaw", Stroke::Plain),
];

type Gyro = VirtualGyro<f64, 5, 5>;

fn main() -> ExitCode {
    program::run(include_str!("vr_application.rs"), 1, run)
}

fn run(text: &mut String) -> Result<(), Box<dyn Error>> {
    let lever_arm = Head::ON_THE_NECK;
    let motion = motion::chosen("a generated head", Head { lever_arm })?
        .lasting(1.0)?
        .with_truth()?
        .with_field()?;
    let mut gyro = Gyro::new(Settings {
        sample_period: Seconds(1.0 / RATE),
        method: Method::Matrix,
    });
    let mut drawn: [Vec<[f64; 2]>; 6] = Default::default();
    let (mut squares, mut lines) = (0.0, 0);
    writeln!(text, "{}", motion.describe())?;
    writeln!(
        text,
        "time (s)   six raw values                          roll   pitch     yaw (°)   off (°)"
    )?;
    for k in 0..(motion.seconds * RATE) as u32 {
        let t = f64::from(k) / RATE;
        let instant = motion.at(t);
        let line = board(&instant);
        let (Some(estimate), Some(truth)) = (host(&mut gyro, &line)?, motion::truth(&instant))
        else {
            continue;
        };
        // What a renderer with y up takes for its camera.
        let camera = Axes::NorthEastDown.orientation_to_y_up(estimate.orientation);
        let off = camera.angle_to(&truth).to_degrees();
        squares += off * off;
        lines += 1;
        let found = degrees(estimate.angles);
        if motion.middle().contains(&t) {
            let truth = Axes::NorthEastDown.orientation_from_y_up(truth);
            let truth = degrees(attitude_quaternion::to_angles(&truth, None));
            for (points, degrees) in drawn.iter_mut().zip(truth.into_iter().chain(found)) {
                points.push([t, degrees]);
            }
        }
        if k % 200 == 0 {
            let [roll, pitch, yaw] = found;
            writeln!(
                text,
                "{t:8.2}   {line:36} {roll:7.1} {pitch:7.1} {yaw:7.1} {off:13.1}"
            )?;
        }
    }
    if lines == 0 {
        return Err(
            "nowhere is there an attitude: no gravity, no magnetic field, or the two are parallel"
                .into(),
        );
    }
    let rms = f64::sqrt(squares / f64::from(lines));
    writeln!(text, "camera off by {rms:.2}° rms over {lines} lines")?;
    let lines = LINES.into_iter().zip(drawn);
    let lines = lines.map(|((name, _), points)| Line { name, points });
    let look = Look {
        scales: [Scale::Even, Scale::Circle],
        strokes: &LINES.map(|(_, stroke)| stroke),
    };
    let picture = Picture {
        title: &format!("Six raw values in, three angles out: {}", motion.name),
        x: "time (s)",
        y: "angle (°)",
        lines: lines.collect(),
    };
    Ok(writeln!(
        text,
        "{}",
        picture.save_with("vr_application", &look)?.display()
    )?)
}

fn degrees(angles: TaitBryan<f64>) -> [f64; 3] {
    [angles.roll, angles.pitch, angles.yaw].map(Angle::degrees)
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
