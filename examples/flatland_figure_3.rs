//! Why blend two sensors? Figure 3 of the course notes (000, section 3) rebuilt: one roll angle by the
//! gyro (eq. 7), by the accelerometer (eq. 8) and by both (eq. 9).
//!
//! Run with `cargo run --example flatland_figure_3`. The figure's own data were not published: the
//! sensors are simulated (eq. 1 and 2), so that the truth is known too. Expect the gyro to be calm and
//! to drift away, the accelerometer to be noisy and to stay, and the fused angle to do neither.

#[path = "picture/mod.rs"]
mod picture;

#[path = "program/mod.rs"]
mod program;

use nalgebra::Vector3;
use picture::{Line, Look, Picture, Scale, Stroke};
use std::error::Error;
use std::fmt::Write as _;
use std::process::ExitCode;
use vrduino::calibration::GyroBias;
use vrduino::imu::RANGES;
use vrduino::orientation::TimeConstant;
use vrduino::orientation::flatland::{Flatland, shortest_turn};
use vrduino::sensor::measurement::MeasurementModel;
use vrduino::sensor::simulation::{SimulatedImu, SimulatedTriad};
use vrduino::units::{Angle, AngularRate, METRES_PER_S2_PER_G, Seconds, SpecificForce};

const PERIOD: f64 = 0.01;
const STEPS: u32 = 6000;
/// The steps whose errors are averaged to see what is left of them without the noise.
const LAST: u32 = 1000;
const ALPHA: f64 = 0.98;
/// What calibration left of the gyro's bias, and the noise of each sensor.
const BIAS_DPS: f64 = 0.3;
const GYRO_NOISE_DPS: f64 = 0.1;
const ACCELEROMETER_NOISE: f64 = 0.5;

/// The truth beneath, what is noisy above it, and on top what is made of both.
const LINES: [(&str, Stroke); 4] = [
    ("truth", Stroke::Broad),
    ("accelerometer", Stroke::Fine),
    ("gyro", Stroke::Plain),
    ("fused", Stroke::Plain),
];

/// Roll (rad) and its rate (rad/s): a slow swing to 30°.
fn truth(t: f64) -> (f64, f64) {
    let (amplitude, frequency) = (30_f64.to_radians(), 0.5);
    let (sin, cos) = (frequency * t).sin_cos();
    (amplitude * sin, amplitude * frequency * cos)
}

fn main() -> ExitCode {
    program::run(include_str!("flatland_figure_3.rs"), 0, run)
}

fn run(text: &mut String) -> Result<(), Box<dyn Error>> {
    let all = |value| Vector3::repeat(value);
    let mut imu = SimulatedImu::new(
        SimulatedTriad::new(
            MeasurementModel::aligned(AngularRate::from_dps(all(BIAS_DPS))),
            AngularRate::from_dps(all(GYRO_NOISE_DPS)),
        ),
        SimulatedTriad::new(
            MeasurementModel::ideal(),
            SpecificForce::from_m_per_s2(all(ACCELEROMETER_NOISE)),
        ),
        RANGES,
        1,
    );
    let period = Seconds(PERIOD);
    let mut flat = Flatland::new(TimeConstant::from_gyro_weight(ALPHA, period), period);
    let mut lines = LINES.map(|(name, _)| Line {
        name,
        points: Vec::new(),
    });
    let (mut squares, mut means) = ([0.0; 3], [0.0; 3]);
    for step in 1..=STEPS {
        let t = f64::from(step) * PERIOD;
        // A step's rate is that of its beginning (eq. 6), its force that of its end.
        let (rate, roll) = (truth(t - PERIOD).1, truth(t).0);
        let up = Vector3::new(roll.sin(), roll.cos(), 0.0) * METRES_PER_S2_PER_G;
        let raw = imu.sample(
            AngularRate::from_rad_per_s(Vector3::z() * rate),
            SpecificForce::from_m_per_s2(up),
        );
        let found = flat.update(&GyroBias::zero().correct(RANGES.sample(&raw)));
        let angles = [found.accelerometer, found.gyro, found.fused];
        for (i, angle) in angles.into_iter().enumerate() {
            let error = shortest_turn(Angle::from_rad(roll), angle).degrees();
            squares[i] += error * error / f64::from(STEPS);
            if step > STEPS - LAST {
                means[i] += error / f64::from(LAST);
            }
        }
        let drawn = [roll.to_degrees()].into_iter();
        let drawn = drawn.chain(angles.map(Angle::degrees));
        for (line, angle) in lines.iter_mut().zip(drawn) {
            line.points.push([t, angle]);
        }
    }
    writeln!(
        text,
        "α = {ALPHA}, {} s at {PERIOD} s a sample, {BIAS_DPS} °/s of bias",
        f64::from(STEPS) * PERIOD
    )?;
    let last = f64::from(LAST) * PERIOD;
    writeln!(
        text,
        "{:13} {:>10}   mean of the last {last} s",
        "", "rms error"
    )?;
    for ((name, _), (square, mean)) in LINES.iter().skip(1).zip(squares.iter().zip(means)) {
        writeln!(text, "{name:13} {:9.2}° {mean:11.2}°", square.sqrt())?;
    }
    let look = Look {
        scales: [Scale::Even; 2],
        strokes: &LINES.map(|(_, stroke)| stroke),
    };
    let picture = Picture {
        title: "Roll in flatland, by simulated sensors (course notes, figure 3)",
        x: "time (s)",
        y: "roll (°)",
        lines: lines.into(),
    };
    Ok(writeln!(
        text,
        "{}",
        picture.save_with("flatland_figure_3", &look)?.display()
    )?)
}
