//! How near does a gyro made of accelerometer and magnetometer come to a real one? Figures 7 and 8
//! of the gyroscope-emulation paper (5.1, 5.2), by both its methods and both kinds of cut-off.
//!
//! Run with `cargo run --example virtual_gyro`, on a generated motion, or with a recording:
//! `cargo run --example virtual_gyro -- FILE` (.imub or .csv). Expect gravity to stay near 1 g under
//! shakes of 2 g with a cut-off that is fixed, and to go with them where it adapts; and of a slow turn
//! a rate like the gyro's but late, the same from both methods. Of quick motions, and of a device that
//! is carried about, expect a rate that is further from the gyro's than zero is: no filter tells their
//! acceleration from gravity.

#[path = "motion/mod.rs"]
mod motion;

#[path = "picture/mod.rs"]
mod picture;

#[path = "program/mod.rs"]
mod program;

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::{self, Write as _};
use std::process::ExitCode;

use nalgebra::Vector3;
use picture::{Line, Look, Picture, Scale, Stroke};
use vrduino::frames::axes::Axes;
use vrduino::units::{METRES_PER_S2_PER_G as G, MagneticField, Seconds, SpecificForce};
use vrduino::virtual_gyro::butterworth::CutOff;
use vrduino::virtual_gyro::{Fields, GimbalLock, GravityExtraction, Method, Settings, VirtualGyro};
use vrduino_emulator::motion::{Head, Imperfect, Imperfections, Instant};

/// Samples a second: few, for a rate is a difference of attitudes and their noise over the period.
const RATE: f64 = 36.0;

/// Of the generated motion's accelerometer (m/s²): a hand that trembles, so that the adaptive
/// cut-off opens.
const TREMOR: f64 = 1.0;

/// The largest delay that is tried (samples).
const LATEST: usize = 40;

/// What is noisy thin, what may lie on another line dashed.
const GRAVITY: [Stroke; 5] = [
    Stroke::Fine,
    Stroke::Plain,
    Stroke::Plain,
    Stroke::Plain,
    Stroke::Dashed,
];

/// The gyro beneath, and of the two methods, which find the same, the second dashed.
const RATES: [Stroke; 5] = [
    Stroke::Broad,
    Stroke::Plain,
    Stroke::Plain,
    Stroke::Dashed,
    Stroke::Dashed,
];

type Extraction = GravityExtraction<f64, 5, 5>;

/// What there is while the windows fill.
const NONE: Vector3<f64> = Vector3::new(f64::NAN, f64::NAN, f64::NAN);

/// ‖g_d‖ in g and ω_d in °/s, along the axes of the readings.
type Estimate = (f64, Vector3<f64>);

fn main() -> ExitCode {
    program::run(include_str!("virtual_gyro.rs"), 1, run)
}

fn run(text: &mut String) -> Result<(), Box<dyn Error>> {
    let lever_arm = Head::ON_THE_NECK;
    let trembling = Imperfections {
        accel_noise: TREMOR,
        ..Imperfections::default()
    };
    let head = Imperfect::new(Box::new(Head { lever_arm }), trembling);
    let motion = motion::chosen("a generated head that trembles", head)?
        .lasting(5.0)?
        .with_field()?;
    let fixed = CutOff::new(0.02).ok_or("no such cut-off")?;
    let fixed = Extraction::with_cut_off(fixed);
    writeln!(
        text,
        "held in three positions, shaken five times a second in the first"
    )?;
    writeln!(
        text,
        "cut-off    shaken by (g)   |g_d| off (g)   down off (°)"
    )?;
    let mut shaken = Vec::new();
    for shake in [0.0, 2.0] {
        figure_7(text, "adaptive", Extraction::new(), shake)?;
        shaken = figure_7(text, "fixed", fixed.clone(), shake)?;
    }
    let picture = Picture {
        title: "Gravity extracted under shakes of 2 g, fixed cut-off (paper, figure 7)",
        x: "time (s)",
        y: "acceleration (g)",
        lines: shaken,
    };
    writeln!(
        text,
        "{}\n",
        picture
            .save_with("virtual_gyro_gravity", &look(&GRAVITY))?
            .display()
    )?;

    writeln!(text, "{}", motion.describe())?;
    let count = (motion.seconds * RATE) as u32;
    let instants: Vec<Instant> = (0..count).map(|k| motion.at(f64::from(k) / RATE)).collect();
    let degrees = |i: &Instant| Vector3::from(i.rate.map(f64::to_degrees));
    let real: Vec<Vector3<f64>> = instants.iter().map(degrees).collect();
    let of_gyro = rms(real.iter().map(|rate| rate.norm_squared() / 3.0));
    writeln!(
        text,
        "                    ‖g_d‖ off   error of the rate   delay"
    )?;
    writeln!(
        text,
        "method, cut-off      (g, rms)          (°/s, rms)    (ms)"
    )?;
    writeln!(text, "always zero                 – {of_gyro:19.1}       –")?;
    let mut rates = vec![line("gyro", real.iter().map(|rate| rate.y))];
    let angles = Method::Angles(GimbalLock::Resolve);
    let mut least = f64::INFINITY;
    for (name, method, extraction) in [
        ("angles, adaptive", angles, Extraction::new()),
        ("angles, fixed", angles, fixed.clone()),
        ("matrix, adaptive", Method::Matrix, Extraction::new()),
        ("matrix, fixed", Method::Matrix, fixed),
    ] {
        let made = estimates(method, extraction, &instants);
        let errors = (0..LATEST).map(|late| (late, error(&made, &real, late)));
        let errors = errors.filter(|(_, error)| error.is_finite());
        let best = errors.min_by(|a, b| a.1.total_cmp(&b.1));
        let (late, error) = best.ok_or(
            "nowhere is there an attitude: no gravity, no magnetic field, or the two are parallel",
        )?;
        let off = made.iter().map(|(norm, _)| (norm - 1.0).powi(2));
        let off = rms(off.filter(|off| off.is_finite()));
        let delay = 1000.0 * late as f64 / RATE;
        writeln!(text, "{name:17} {off:11.3} {error:19.1} {delay:7.0}")?;
        least = least.min(error);
        rates.push(line(name, made.iter().map(|e| e.1.y)));
    }
    let verdict = if least < of_gyro {
        "the best of them is nearer to the gyro than zero is"
    } else {
        "none of them is as near to the gyro as zero is: too much that is not gravity was taken for it"
    };
    writeln!(text, "{verdict}")?;
    let mut picture = Picture {
        title: &format!(
            "Rate about the device's y axis by gyro and virtual gyro: {}",
            motion.name
        ),
        x: "time (s)",
        y: "rate (°/s)",
        lines: rates,
    };
    let drawn = motion.middle();
    for line in &mut picture.lines {
        line.points.retain(|[t, _]| drawn.contains(t));
    }
    Ok(writeln!(
        text,
        "{}",
        picture.save_with("virtual_gyro", &look(&RATES))?.display()
    )?)
}

/// Figure 7: x, y and z point down for 5 s each; from 2 to 4 s the device is shaken five times a
/// second, by up to `shake` (g). Draws what comes in and what is left of it, as norm and axes (g).
fn figure_7(
    text: &mut String,
    cut_off: &str,
    mut extraction: Extraction,
    shake: f64,
) -> Result<Vec<Line<'static>>, fmt::Error> {
    let (mut values, mut norm_off, mut down_off) = (Vec::new(), 0.0_f64, 0.0_f64);
    for t in (0..(15.0 * RATE) as u32).map(|k| f64::from(k) / RATE) {
        let down = Vector3::ith((t / 5.0) as usize, G);
        let shake = f64::from((2.0..4.0).contains(&t)) * shake * (TAU * 5.0 * t).sin();
        let push = Vector3::repeat(1.0).normalize() * (shake * G);
        let (gravity, magnetic) = (down + push, Vector3::zeros());
        let found = extraction.update(Fields { gravity, magnetic }).ok();
        let g = found.flatten().map_or(NONE, |found| found.gravity / G);
        values.push([gravity.norm() / G, g.x, g.y, g.z, g.norm()]);
        if t < 5.0 {
            norm_off = norm_off.max((g.norm() - 1.0).abs());
            down_off = down_off.max(g.angle(&down).to_degrees());
        }
    }
    writeln!(
        text,
        "{cut_off:8} {shake:15} {norm_off:15.3} {down_off:14.1}"
    )?;
    let names = ["‖sensor‖", "x extracted", "y", "z", "‖extracted‖"];
    let lines = names.into_iter().enumerate();
    let lines = lines.map(|(column, name)| line(name, values.iter().map(|row| row[column])));
    Ok(lines.collect())
}

fn look(strokes: &[Stroke]) -> Look<'_> {
    let scales = [Scale::Even; 2];
    Look { scales, strokes }
}

fn line(name: &str, values: impl Iterator<Item = f64>) -> Line<'_> {
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

/// Root mean square over all axes of what the rate is off by, if it is so many samples late.
fn error(made: &[Estimate], real: &[Vector3<f64>], late: usize) -> f64 {
    let pairs = made.iter().skip(late).zip(real);
    let squares = pairs.map(|((_, made), real)| (made - real).norm_squared() / 3.0);
    rms(squares.filter(|square| square.is_finite()))
}

/// Of squares.
fn rms(squares: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| {
        (sum + square, count + 1.0)
    });
    f64::sqrt(sum / count)
}
