//! How near does a gyro made of accelerometer and magnetometer come to a real one? Figures 7 and 8
//! of the gyroscope-emulation paper (5.1, 5.2), by both its methods and both kinds of cut-off.
//!
//! Run with `cargo run --example virtual_gyro`, or behind it `-- RECORDING.imub`. Expect gravity to
//! stay near 1 g under shakes of 2 g with a cut-off that is fixed, and to go with them where it
//! adapts; and of a slow motion a rate like the gyro's but late, the same from both methods.

use std::f64::consts::TAU;
use std::io;
use std::process::ExitCode;

use nalgebra::Vector3;
use vrduino::frames::axes::Axes;
use vrduino::units::{METRES_PER_S2_PER_G as G, MagneticField, Seconds, SpecificForce};
use vrduino::virtual_gyro::butterworth::CutOff;
use vrduino::virtual_gyro::{Fields, GimbalLock, GravityExtraction, Method, Settings, VirtualGyro};
use vrduino_emulator::motion::{self, Head, Instant};

#[path = "picture/mod.rs"]
mod picture;
use picture::{Line, Picture};

/// Samples a second: few, for a rate is a difference of attitudes and their noise over the period.
const RATE: f64 = 36.0;

type Extraction = GravityExtraction<f64, 5, 5>;

/// What there is while the windows fill.
const NONE: Vector3<f64> = Vector3::new(f64::NAN, f64::NAN, f64::NAN);

/// ‖g_d‖ in g and ω_d in °/s, along the axes of the readings.
type Estimate = (f64, Vector3<f64>);

fn main() -> ExitCode {
    if let Err(error) = run() {
        eprintln!("error: {error}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let fixed = CutOff::new(0.02).ok_or("no such cut-off")?;
    let fixed = Extraction::with_cut_off(fixed);
    println!("cut-off    shaken by (g)   |g_d| off (g)   down off (°)");
    let mut shaken = Vec::new();
    for shake in [0.0, 2.0] {
        figure_7("adaptive", Extraction::new(), shake);
        shaken = figure_7("fixed", fixed.clone(), shake);
    }
    draw("virtual_gyro_gravity", "Gravity", "g", shaken)?;
    // The recording named on the command line, or else a head on its neck.
    let lever_arm = Head::ON_THE_NECK;
    let motion = match std::env::args_os().nth(1) {
        Some(path) => motion::open(path.as_ref())?,
        None => Box::new(Head { lever_arm }),
    };
    println!("{}", motion.describe());
    let count = (motion.duration().unwrap_or(60.0) * RATE) as u32;
    let at = |k| motion.at(f64::from(k) / RATE);
    let instants: Vec<Instant> = (0..count).map(at).collect();
    let degrees = |i: &Instant| Vector3::from(i.rate.map(f64::to_degrees));
    let real: Vec<Vector3<f64>> = instants.iter().map(degrees).collect();
    let mut rates = vec![line("gyro", real.iter().map(|rate| rate.y))];
    let angles = Method::Angles(GimbalLock::Resolve);
    println!("method, cut-off   |g_d| off (g)   gyro   error (°/s rms)   samples late");
    for (name, method, extraction) in [
        ("angles, adaptive", angles, Extraction::new()),
        ("angles, fixed", angles, fixed.clone()),
        ("matrix, adaptive", Method::Matrix, Extraction::new()),
        ("matrix, fixed", Method::Matrix, fixed),
    ] {
        let made = estimates(method, extraction, &instants);
        let scores = (0..40).map(|late| (late, score(&made, &real, late)));
        let best = scores.min_by(|a, b| a.1[2].total_cmp(&b.1[2]));
        let best = best.filter(|(_, score)| score[2].is_finite());
        let (late, [off, gyro, error]) = best.ok_or("too short, or without a magnetic field")?;
        println!("{name:17} {off:13.3} {gyro:6.1} {error:17.1} {late:14}");
        rates.push(line(name, made.iter().map(|e| e.1.y)));
    }
    Ok(draw("virtual_gyro", "Rate about y", "rate (°/s)", rates)?)
}

/// Figure 7: x, y and z point down for 5 s each; from 2 to 4 s the device is shaken five times a
/// second, by up to `shake` (g). Draws what comes in and what is left of it, as norm and axes (g).
fn figure_7(cut_off: &str, mut extraction: Extraction, shake: f64) -> Vec<Line<'static>> {
    let (mut values, mut norm_off, mut down_off) = (Vec::new(), 0.0_f64, 0.0_f64);
    for t in (0..(15.0 * RATE) as u32).map(|k| f64::from(k) / RATE) {
        let down = Vector3::ith((t / 5.0) as usize, G);
        let shake = f64::from((2.0..4.0).contains(&t)) * shake * (TAU * 5.0 * t).sin();
        let push = Vector3::repeat(1.0).normalize() * (shake * G);
        let (gravity, magnetic) = (down + push, Vector3::zeros());
        let found = extraction.update(Fields { gravity, magnetic }).ok();
        let g = found.flatten().map_or(NONE, |found| found.gravity / G);
        values.push([gravity.norm() / G, g.norm(), g.x, g.y, g.z]);
        if t < 5.0 {
            norm_off = norm_off.max((g.norm() - 1.0).abs());
            down_off = down_off.max(g.angle(&down).to_degrees());
        }
    }
    println!("{cut_off:8} {shake:15} {norm_off:15.3} {down_off:14.1}");
    let names = ["sensor", "extracted", "x", "y", "z"].iter().enumerate();
    let lines = names.map(|(column, name)| line(name, values.iter().map(|row| row[column])));
    lines.collect()
}

fn draw(name: &str, title: &'static str, y: &'static str, lines: Vec<Line>) -> io::Result<()> {
    let x = "time (s)";
    println!("{}", Picture { title, x, y, lines }.save(name)?.display());
    Ok(())
}

fn line(name: &'static str, values: impl Iterator<Item = f64>) -> Line<'static> {
    let values = values.enumerate();
    let points = values.map(|(k, y)| [k as f64 / RATE, y]).collect();
    Line { name, points }
}

fn estimates(method: Method, extraction: Extraction, instants: &[Instant]) -> Vec<Estimate> {
    let settings = Settings {
        sample_period: Seconds(1.0 / RATE),
        method,
    };
    let mut gyro = VirtualGyro::with_extraction(settings, extraction);
    let paper_axes = |v: [f64; 3]| Axes::NorthEastDown.from_y_up(Vector3::from(v));
    let mut feed = |instant: &Instant| {
        let force = SpecificForce::from_m_per_s2(paper_axes(instant.force));
        let field = MagneticField::from_microtesla(paper_axes(instant.magnetic_field()));
        let estimate = gyro.update(force, Some(field)).ok()?;
        let rate = Axes::NorthEastDown.to_y_up(estimate.velocity?.device.dps());
        Some((estimate.fields.gravity.norm() / G, rate))
    };
    let made = instants.iter().map(|i| feed(i).unwrap_or((f64::NAN, NONE)));
    made.collect()
}

/// Root mean squares over all axes of ‖g_d‖ − 1 g, of the gyro, and of the error beside it.
fn score(made: &[Estimate], real: &[Vector3<f64>], late: usize) -> [f64; 3] {
    let pairs = made.iter().skip(late).zip(real);
    let (mut sums, mut count) = (Vector3::zeros(), 0.0);
    for ((norm, made), real) in pairs.filter(|(made, _)| made.0.is_finite()) {
        let (gyro, error) = (real.norm_squared(), (made - real).norm_squared());
        sums += Vector3::new((norm - 1.0).powi(2), gyro / 3.0, error / 3.0);
        count += 1.0;
    }
    (sums / count).map(f64::sqrt).into()
}
