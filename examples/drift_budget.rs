//! Where does a gyro's drift come from? The course notes (000, section 3.1) and the lecture (003) blame
//! the integration: here its error and that of a bias are told apart.
//!
//! Run with `cargo run --example drift_budget`. A board swings by 60° to and fro once a second for almost
//! a minute. Expect the error of integration to stay within one step's worth, however long it lasts, and
//! the error of a bias to grow with time, whatever the step; the prediction is their sum.

#[path = "picture/mod.rs"]
mod picture;

#[path = "program/mod.rs"]
mod program;

use nalgebra::Vector3;
use picture::{Line, Picture};
use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::process::ExitCode;
use vrduino::calibration::{GyroBias, Reading};
use vrduino::orientation::TimeConstant;
use vrduino::orientation::flatland::error::{gyro_drift, integration_error};
use vrduino::orientation::flatland::{Flatland, shortest_turn};
use vrduino::sensor::Sample;
use vrduino::units::{Angle, AngularRate, Seconds, SpecificForce};

/// Ends in the middle of a swing: after whole ones the error of integration is zero.
const SECONDS: f64 = 59.5;

/// Angle and rate at `t`.
fn swing(t: f64) -> (Angle<f64>, AngularRate<f64>) {
    let (sin, cos) = (TAU * t).sin_cos();
    let rate = AngularRate::from_dps(Vector3::z() * 60.0 * TAU * cos);
    (Angle::from_degrees(60.0 * sin), rate)
}

fn bias(dps: f64) -> AngularRate<f64> {
    AngularRate::from_dps(Vector3::z() * dps)
}

fn reading(rate: AngularRate<f64>, bias: AngularRate<f64>) -> Reading<f64> {
    GyroBias::zero().correct(Sample {
        rate: AngularRate::from_rad_per_s(rate.rad_per_s() + bias.rad_per_s()),
        force: SpecificForce::from_g(Vector3::zeros()),
    })
}

/// Time (s) and error (°) of eq. 7, step by step.
fn errors(step: f64, bias_dps: f64) -> Vec<[f64; 2]> {
    let period = Seconds(step);
    let mut flat = Flatland::new(TimeConstant::from_gyro_weight(1.0, period), period);
    (1..=(SECONDS / step).round() as u32)
        .map(|k| {
            let rate = swing(f64::from(k - 1) * step).1;
            let roll = flat.update(&reading(rate, bias(bias_dps)));
            let t = f64::from(k) * step;
            [t, shortest_turn(swing(t).0, roll.gyro).degrees()]
        })
        .collect()
}

fn main() -> ExitCode {
    program::run(include_str!("drift_budget.rs"), 0, run)
}

fn run(text: &mut String) -> Result<(), Box<dyn Error>> {
    writeln!(
        text,
        "   Δt       bias   worst error   error at end   predicted"
    )?;
    for step in [0.02, 0.01, 0.001] {
        for bias_dps in [0.0, 0.01, 0.1, 1.0] {
            let errors = errors(step, bias_dps);
            let worst = errors.iter().map(|point| point[1].abs()).reduce(f64::max);
            let last = errors.last().map(|point| point[1]);
            let predicted = gyro_drift(bias(bias_dps), Seconds(SECONDS)).degrees()
                + integration_error(swing(0.0).1, swing(SECONDS).1, Seconds(step)).degrees();
            writeln!(
                text,
                "{:3} ms  {bias_dps:5} °/s  {:11.3}°  {:12.3}°  {predicted:9.3}°",
                step * 1000.0,
                worst.unwrap_or(f64::NAN),
                last.unwrap_or(f64::NAN)
            )?;
        }
    }
    let line = |name, step, bias_dps| Line {
        name,
        // Every 20 ms are enough to draw.
        points: (errors(step, bias_dps).into_iter())
            .step_by((0.02 / step).round() as usize)
            .collect(),
    };
    let picture = Picture {
        title: "Drift of the gyro, integration against bias: a swing of 60° to and fro each second",
        x: "time (s)",
        y: "error (°)",
        lines: vec![
            line("10 ms, no bias", 0.01, 0.0),
            line("1 ms, no bias", 0.001, 0.0),
            line("10 ms, 0.1 °/s", 0.01, 0.1),
            line("1 ms, 0.1 °/s", 0.001, 0.1),
        ],
    };
    Ok(writeln!(
        text,
        "{}",
        picture.save("drift_budget")?.display()
    )?)
}
