//! How near does a gyro made of accelerometer and magnetometer come to a real one? Figures 7 and 8
//! of the gyroscope-emulation paper (5.1, 5.2), by both its methods and both kinds of cut-off.
//!
//! Run with `cargo run --example virtual_gyro`, or behind it `-- RECORDING.imub`. Expect the norm of
//! the extracted gravity near 1 g, a rate like the gyro's but late, and the same from both methods.

use std::process::ExitCode;

use nalgebra::Vector3;
use vrduino::frames::axes::Axes;
use vrduino::units::{METRES_PER_S2_PER_G, MagneticField, Seconds, SpecificForce};
use vrduino::virtual_gyro::butterworth::CutOff;
use vrduino::virtual_gyro::{GimbalLock, GravityExtraction, Method, Settings, VirtualGyro};
use vrduino_emulator::motion::{self, Head, Instant, Motion, MotionError};

#[path = "picture/mod.rs"]
mod picture;
use picture::{Line, Picture};

/// Samples a second: few, for a rate is a difference of attitudes and their noise over the period.
const RATE: f64 = 36.0;

/// ‖g_d‖ in g and ω_d in °/s, along the axes of the readings; NaN where there is no estimate.
type Estimate = (f64, Vector3<f64>);

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
    let count = (motion.duration().unwrap_or(60.0) * RATE) as u32;
    let times = (0..count).map(|k| f64::from(k) / RATE);
    let instants: Vec<Instant> = times.map(|t| motion.at(t)).collect();
    let real = instants.iter().map(|i| {
        let norm = Vector3::from(i.force).norm() / METRES_PER_S2_PER_G;
        (norm, Vector3::from(i.rate.map(f64::to_degrees)))
    });
    let real: Vec<Estimate> = real.collect();
    let fixed = GravityExtraction::with_cut_off(CutOff::new(0.02).ok_or("no such cut-off")?);
    let angles = Method::Angles(GimbalLock::Resolve);
    let mut norms = vec![line("sensor", &real, |e| e.0)];
    let mut rates = vec![line("gyro", &real, |e| e.1.y)];
    println!("method, cut-off   |g_d| off (g)   gyro   error (°/s rms)   samples late");
    for (name, method, extraction) in [
        ("angles, adaptive", angles, GravityExtraction::new()),
        ("angles, fixed", angles, fixed.clone()),
        ("matrix, adaptive", Method::Matrix, GravityExtraction::new()),
        ("matrix, fixed", Method::Matrix, fixed),
    ] {
        let sample_period = Seconds(1.0 / RATE);
        let settings = Settings {
            sample_period,
            method,
        };
        let gyro = VirtualGyro::with_extraction(settings, extraction);
        let made = estimates(gyro, &instants);
        let scores = (0..40).map(|late| (late, score(&made, &real, late)));
        let best = scores.min_by(|a, b| a.1[2].total_cmp(&b.1[2]));
        let best = best.filter(|(_, score)| score[2].is_finite());
        let (late, [off, gyro, error]) = best.ok_or("too short, or without a magnetic field")?;
        println!("{name:17} {off:13.3} {gyro:6.1} {error:17.1} {late:14}");
        norms.push(line(name, &made, |e| e.0));
        rates.push(line(name, &made, |e| e.1.y));
    }
    let draw = |name, title, y, lines| {
        let x = "time (s)";
        let path = Picture { title, x, y, lines }.save(name)?;
        println!("{}", path.display());
        std::io::Result::Ok(())
    };
    draw("virtual_gyro_gravity", "Gravity", "norm (g)", norms)?;
    Ok(draw("virtual_gyro", "Rate about y", "rate (°/s)", rates)?)
}

fn line(name: &'static str, estimates: &[Estimate], value: fn(&Estimate) -> f64) -> Line {
    let points = estimates.iter().enumerate();
    let points = points.map(|(k, e)| [k as f64 / RATE, value(e)]).collect();
    Line { name, points }
}

fn estimates(mut gyro: VirtualGyro<f64, 5, 5>, instants: &[Instant]) -> Vec<Estimate> {
    let paper_axes = |v: [f64; 3]| Axes::NorthEastDown.from_y_up(Vector3::from(v));
    let mut feed = |instant: &Instant| {
        let force = SpecificForce::from_m_per_s2(paper_axes(instant.force));
        let field = MagneticField::from_microtesla(paper_axes(instant.magnetic_field()));
        let estimate = gyro.update(force, Some(field)).ok()?;
        let rate = Axes::NorthEastDown.to_y_up(estimate.velocity?.device.dps());
        Some((estimate.fields.gravity.norm() / METRES_PER_S2_PER_G, rate))
    };
    let none = (f64::NAN, Vector3::repeat(f64::NAN));
    instants.iter().map(|i| feed(i).unwrap_or(none)).collect()
}

/// Root mean squares over all axes of ‖g_d‖ − 1 g, of the gyro, and of the error beside it.
fn score(made: &[Estimate], real: &[Estimate], late: usize) -> [f64; 3] {
    let pairs = made.iter().skip(late).zip(real);
    let (mut sums, mut count) = (Vector3::zeros(), 0.0);
    for ((norm, made), (_, real)) in pairs.filter(|(made, _)| made.0.is_finite()) {
        let (gyro, error) = (real.norm_squared(), (made - real).norm_squared());
        sums += Vector3::new((norm - 1.0).powi(2), gyro / 3.0, error / 3.0);
        count += 1.0;
    }
    (sums / count).map(f64::sqrt).into()
}

/// The recording named on the command line, or else a head on its neck.
fn motion() -> Result<Box<dyn Motion>, MotionError> {
    if let Some(path) = std::env::args_os().nth(1) {
        return motion::open(path.as_ref());
    }
    let lever_arm = Head::ON_THE_NECK;
    Ok(Box::new(Head { lever_arm }))
}
