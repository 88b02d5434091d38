//! Which weight should the gyro have? α of the complementary filter (000, eq. 24) against the error of
//! inclination on a motion with known truth.
//!
//! Run with `cargo run --example alpha_sweep`, on a generated head, or with a recording:
//! `cargo run --example alpha_sweep -- FILE` (.imub or .csv). Expect a best weight between the ends: a
//! small α follows every acceleration as if it were a change of up, α = 1 drifts. A weight means nothing
//! without the sample period, so the time constant is printed beside it. The gyro is used as a
//! tracker does, without the bias it shows at rest, and beside that as it is: a bias left in it asks
//! for a shorter time. The library's 7.6 s is the best for many motions together; a single one may
//! have its minimum elsewhere.

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
use vrduino::orientation::TimeConstant;
use vrduino::orientation::complementary::Complementary;
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, Seconds, SpecificForce};
use vrduino_emulator::motion::{Head, Imperfect, Imperfections};

/// That of the BROAD recordings (2000/7 Hz), so that theirs are the samples themselves.
const PERIOD: Seconds<f64> = Seconds(0.0035);
const ALPHAS: [f64; 15] = [
    0.0, 0.5, 0.9, 0.95, 0.98, 0.99, 0.995, 0.998, 0.999, 0.9995, 0.9998, 0.9999, 0.99995, 0.99999,
    1.0,
];

/// Root mean square and largest error of inclination (°).
fn errors(motion: &Chosen, bias: GyroBias<f64>, weight: TimeConstant<f64>) -> [f64; 2] {
    let mut filter = Complementary::new(weight, PERIOD);
    let force = motion.at(0.0).force;
    filter.reset(SpecificForce::from_m_per_s2(Vector3::from(force)));
    let (mut squares, mut worst, mut compared) = (0.0, 0.0_f64, 0.0);
    for step in 0..=(motion.seconds / PERIOD.0) as u32 {
        let now = motion.at(f64::from(step) * PERIOD.0);
        let found = filter.update(&bias.correct(Sample {
            rate: AngularRate::from_rad_per_s(Vector3::from(now.rate)),
            force: SpecificForce::from_m_per_s2(Vector3::from(now.force)),
        }));
        if let Some(truth) = motion::truth(&now) {
            // Between the two directions of up in the body: yaw has no part in it.
            let up = |body: UnitQuaternion<f64>| body.inverse() * Vector3::y();
            let error = up(truth).angle(&up(found)).to_degrees();
            squares += error * error;
            worst = worst.max(error);
            compared += 1.0;
        }
    }
    [f64::sqrt(squares / compared), worst]
}

fn main() -> ExitCode {
    program::run(include_str!("alpha_sweep.rs"), 1, run)
}

fn run(text: &mut String) -> Result<(), Box<dyn Error>> {
    let lever_arm = Head::ON_THE_NECK;
    let head = Imperfect::new(Box::new(Head { lever_arm }), Imperfections::default());
    let motion = motion::chosen("a generated head", head)?
        .lasting(5.0)?
        .with_truth()?;
    writeln!(text, "{}", motion.describe())?;
    writeln!(
        text,
        "sample period {} ms; error of inclination",
        PERIOD.0 * 1000.0
    )?;
    writeln!(
        text,
        "                          gyro as it is       without its bias at rest"
    )?;
    writeln!(
        text,
        "       α   time constant      rms     worst            rms     worst"
    )?;
    let ways = [GyroBias::zero(), motion.bias()];
    let mut curves: [Vec<[f64; 2]>; 2] = Default::default();
    let mut best = [[f64::NAN, f64::INFINITY]; 2];
    for alpha in ALPHAS {
        let weight = TimeConstant::from_gyro_weight(alpha, PERIOD);
        let time = weight.time().0;
        let [raw, corrected] = ways.map(|bias| errors(&motion, bias, weight));
        writeln!(
            text,
            "{alpha:8} {time:13.3} s {:7.2}° {:8.2}° {:13.2}° {:8.2}°",
            raw[0], raw[1], corrected[0], corrected[1]
        )?;
        for (which, [rms, _]) in [raw, corrected].into_iter().enumerate() {
            // α = 0 and 1 have no place on this axis: a point that is not finite is not drawn.
            curves[which].push([time, rms]);
            if rms < best[which][1] {
                best[which] = [time, rms];
            }
        }
    }
    let [raw, corrected] = best;
    writeln!(
        text,
        "least rms of these: {:.2}° at {:.1} s with the gyro as it is, {:.2}° at {:.1} s without its bias",
        raw[1], raw[0], corrected[1], corrected[0]
    )?;
    let [raw, corrected] = curves;
    let line = |name, points| Line { name, points };
    let look = Look {
        scales: [Scale::Decades; 2],
        strokes: &[Stroke::Dashed],
    };
    let picture = Picture {
        title: &format!(
            "Error of inclination against the time constant: {}",
            motion.name
        ),
        x: "time constant of the complementary filter (s)",
        y: "rms error of inclination (°)",
        lines: vec![
            line("gyro as it is", raw),
            line("without its bias at rest", corrected),
        ],
    };
    Ok(writeln!(
        text,
        "{}",
        picture.save_with("alpha_sweep", &look)?.display()
    )?)
}
