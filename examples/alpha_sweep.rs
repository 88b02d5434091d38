//! Which weight should the gyro have? α of the complementary filter (000, eq. 24) against the error of
//! inclination on a motion with known truth.
//!
//! Run with `cargo run --example alpha_sweep -- RECORDING.imub`; without a recording a generated head
//! motion is used. Expect a best weight between the ends: a small α follows every acceleration as if
//! it were a change of up, α = 1 drifts. A weight means nothing without the sample period, so the
//! time constant is printed beside it. The gyro is used as recorded, with its bias.

#[path = "picture/mod.rs"]
mod picture;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use picture::{Line, Picture};
use std::error::Error;
use vrduino::calibration::GyroBias;
use vrduino::orientation::TimeConstant;
use vrduino::orientation::complementary::Complementary;
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, Seconds, SpecificForce};
use vrduino_emulator::motion::{self, Head, Imperfect, Imperfections, Motion};

/// That of the BROAD recordings (2000/7 Hz), so that theirs are the samples themselves.
const PERIOD: Seconds<f64> = Seconds(0.0035);
/// As much of a motion without end as is looked at (s).
const LONGEST: f64 = 120.0;
const ALPHAS: [f64; 13] = [
    0.0, 0.5, 0.9, 0.95, 0.98, 0.99, 0.995, 0.998, 0.999, 0.9995, 0.9999, 0.99999, 1.0,
];

/// Root mean square and largest error of inclination (°); None if the motion has no truth.
fn errors(motion: &dyn Motion, weight: TimeConstant<f64>) -> Option<(f64, f64)> {
    let mut filter = Complementary::new(weight, PERIOD);
    filter.reset(SpecificForce::from_m_per_s2(Vector3::from(
        motion.at(0.0).force,
    )));
    let (mut squares, mut worst, mut compared) = (0.0, 0.0_f64, 0.0);
    let seconds = motion.duration().unwrap_or(LONGEST);
    for step in 0..(seconds / PERIOD.0) as u32 {
        let now = motion.at(f64::from(step) * PERIOD.0);
        let found = filter.update(&GyroBias::zero().correct(Sample {
            rate: AngularRate::from_rad_per_s(Vector3::from(now.rate)),
            force: SpecificForce::from_m_per_s2(Vector3::from(now.force)),
        }));
        if let Some([w, x, y, z]) = now.truth {
            let truth = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
            // Between the two directions of up in the body: yaw has no part in it.
            let up = |body: UnitQuaternion<f64>| body.inverse() * Vector3::y();
            let error = up(truth).angle(&up(found)).to_degrees();
            squares += error * error;
            worst = worst.max(error);
            compared += 1.0;
        }
    }
    (compared > 0.0).then(|| ((squares / compared).sqrt(), worst))
}

fn run() -> Result<(), Box<dyn Error>> {
    let motion = match std::env::args_os().nth(1) {
        Some(path) => motion::open(path.as_ref())?,
        None => {
            println!("no recording named, so a generated motion, the sensor carried on the neck:");
            let lever_arm = Head::ON_THE_NECK;
            Box::new(Imperfect::new(
                Box::new(Head { lever_arm }),
                Imperfections::default(),
            ))
        }
    };
    println!("{}", motion.describe());
    println!("sample period {} ms", PERIOD.0 * 1000.0);
    println!("       α   time constant        rms       worst");
    let (mut rms_line, mut best) = (Vec::new(), (f64::NAN, f64::INFINITY));
    for alpha in ALPHAS {
        let weight = TimeConstant::from_gyro_weight(alpha, PERIOD);
        let (rms, worst) = errors(&*motion, weight)
            .ok_or("the motion has no truth to compare with: give one that has")?;
        println!(
            "{alpha:8} {:13.3} s {rms:9.2}° {worst:10.2}°",
            weight.time().0
        );
        // α = 0 and 1 have no place on this axis: a point that is not finite is not drawn.
        rms_line.push([weight.time().0.log10(), rms]);
        if rms < best.1 {
            best = (alpha, rms);
        }
    }
    println!("least rms of these: {:.2}° at α = {}", best.1, best.0);
    let picture = Picture {
        title: "Error of inclination against the weight of the gyro",
        x: "log₁₀ of the time constant (s)",
        y: "rms error (°)",
        lines: vec![Line {
            name: "quaternion filter",
            points: rms_line,
        }],
    };
    println!("{}", picture.save("alpha_sweep")?.display());
    Ok(())
}

fn main() {
    if let Err(problem) = run() {
        eprintln!("error: {problem}");
        std::process::exit(1);
    }
}
