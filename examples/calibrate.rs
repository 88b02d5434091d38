//! What is wrong with this sensor? Every calibration on one recording, or the reason why it has none.
//!
//! Run with `cargo run --release --example calibrate`, or with a recording: `cargo run --release
//! --example calibrate -- FILE` (.imub or .csv). Without one a made-up sensor with known faults is laid
//! on its six faces and then turned every way: expect its faults back. A recording of somebody walking
//! about has no six positions, so expect that to be refused.

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

use motion::Chosen;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use picture::{Line, Look, Picture, Scale};
use vrduino::calibration::coverage::{DIRECTIONS, direction};
use vrduino::calibration::ellipsoid::{self, EllipsoidFit, Magnetometer};
use vrduino::calibration::record::{Gyro, Record};
use vrduino::calibration::six_positions::{CrossAxis, SixPositions, Step};
use vrduino::calibration::{Rest, Stillness, Verdict};
use vrduino::imu::RANGES;
use vrduino::sensor::measurement::{MeasurementModel, specific_force};
use vrduino::sensor::simulation::{Gaussian, SimulatedImu, SimulatedTriad};
use vrduino::sensor::{RawSample, Sample};
use vrduino::units::{AngularRate, MagneticField, SpecificForce};

/// Samples a second, and in how many of them the magnetometer has something new.
const RATE: f64 = 1000.0;
const FIELD_EVERY: usize = 10;

/// What the sensor sends, body frame.
struct Heard {
    raw: RawSample,
    field: Option<MagneticField<f32>>,
}

fn main() -> ExitCode {
    program::run(include_str!("calibrate.rs"), 1, run)
}

fn run(text: &mut String) -> Result<(), Box<dyn Error>> {
    let (name, heard) = match motion::named()? {
        Some(motion) => (motion.name.clone(), recorded(text, &motion)?),
        None => ("a made-up sensor".to_owned(), made_up(text)?),
    };
    let fields: Vec<_> = heard.iter().filter_map(|heard| heard.field).collect();
    let temperature = heard
        .last()
        .map_or(0.0, |heard| heard.raw.temperature_celsius());
    let mut record = Record {
        gyro: gyro(text, &heard)?.map(Gyro::from),
        ..Record::default()
    };
    let mut positions = SixPositions::<f32>::new(RANGES);
    let steps: Vec<_> = heard
        .iter()
        .filter_map(|heard| positions.push(&heard.raw))
        .collect();
    let count = |what: fn(&Step<f32>) -> bool| steps.iter().filter(|step| what(step)).count();
    writeln!(
        text,
        "accelerometer    {} windows on a face, {} tilted, {} moved",
        count(|step| matches!(step, Step::Taken { .. })),
        count(|step| matches!(step, Step::Tilted { .. })),
        count(|step| matches!(step, Step::Moved)),
    )?;
    match positions.result(CrossAxis::Ignore) {
        Ok(result) => {
            row(text, "  bias", result.bias.m_per_s2(), "m/s²")?;
            row(text, "  scale", result.matrix.diagonal(), "")?;
            let (residual, placing) = (result.residual, result.placing.degrees());
            writeln!(
                text,
                "  left over      {residual:.4} m/s², placed {placing:.1}° off"
            )?;
            record.accelerometer = Some(result);
        }
        Err(refusal) => writeln!(text, "  refused        {refusal}")?,
    }
    writeln!(text, "magnetometer     {} fields", fields.len())?;
    let mut fit = EllipsoidFit::new();
    for field in &fields {
        fit.push(Ok(*field));
    }
    let result = fit.result(temperature);
    match &result {
        Ok(result) => magnetometer(text, result)?,
        Err(refusal) => writeln!(text, "  refused        {refusal}")?,
    }
    record.magnetometer = result.as_ref().ok().copied();
    let bytes = record.to_bytes();
    let back = Record::from_bytes(&bytes)?;
    writeln!(
        text,
        "kept             {} bytes, read back alike: {}",
        bytes.len(),
        back == record
    )?;
    if record == Record::default() {
        return Err("every calibration was refused: there is nothing to keep".into());
    }
    writeln!(text, "type this to the board to use and keep it:")?;
    for line in record.lines() {
        writeln!(text, "{line}")?;
    }
    let title = format!("Where the field came from: {name}");
    let look = Look {
        scales: [Scale::Circle, Scale::Even],
        strokes: &[],
    };
    writeln!(
        text,
        "{}",
        picture(&title, &fields, &result)
            .save_with("calibrate", &look)?
            .display()
    )?;
    Ok(())
}

fn row(text: &mut String, name: &str, v: Vector3<f32>, unit: &str) -> fmt::Result {
    writeln!(
        text,
        "{name:16} {:9.4} {:9.4} {:9.4}  {unit}",
        v.x, v.y, v.z
    )
}

fn rows(text: &mut String, name: &str, matrix: &Matrix3<f32>) -> fmt::Result {
    for (name, column) in [name, "", ""].iter().zip(matrix.column_iter()) {
        row(text, name, column.into(), "")?;
    }
    Ok(())
}

/// The first second in which the board lay still.
fn gyro(text: &mut String, heard: &[Heard]) -> Result<Option<Rest>, fmt::Error> {
    let mut stillness = Stillness::new(RANGES);
    let verdicts = heard.iter().map(|heard| stillness.push(&heard.raw));
    let rests: Vec<_> = verdicts
        .filter_map(|verdict| match verdict {
            Verdict::Still(rest) => Some(rest),
            Verdict::Collecting | Verdict::Moved => None,
        })
        .collect();
    writeln!(text, "gyro             {} still windows", rests.len())?;
    let first = rests.first().copied();
    match first {
        Some(rest) => {
            row(text, "  bias", rest.gyro_bias.dps(), "°/s")?;
            writeln!(text, "  at             {:.1} °C", rest.temperature_celsius)?;
        }
        None => writeln!(
            text,
            "  refused        never still: lay the board down and take the hand away"
        )?,
    }
    Ok(first)
}

fn magnetometer(text: &mut String, result: &Magnetometer<f32>) -> fmt::Result {
    row(text, "  hard iron", result.hard_iron.microtesla(), "µT")?;
    rows(text, "  soft iron", &result.soft_iron)?;
    writeln!(
        text,
        "  field          {:.2} µT, varies by {:.2} %",
        result.strength_microtesla, result.error_percent
    )?;
    writeln!(
        text,
        "  seen           {:.0} % of all directions, largest hole {:.0}°",
        result.coverage * 100.0,
        result.largest_hole.degrees()
    )
}

/// Directions of the field about the body's y axis, and those of the map near which there is none.
fn picture<'a>(
    title: &'a str,
    fields: &[MagneticField<f32>],
    result: &Result<Magnetometer<f32>, ellipsoid::Refusal<f32>>,
) -> Picture<'a> {
    let correct = |field: &MagneticField<f32>| match result {
        Ok(result) => result.calibration().corrected(*field).microtesla(),
        Err(_) => field.microtesla(),
    };
    let every = (fields.len() / 3000).max(1);
    let seen = fields.iter().step_by(every).map(correct);
    let seen: Vec<_> = seen.filter_map(|v| v.try_normalize(0.0)).collect();
    let far = |v: &Vector3<f32>| seen.iter().all(|s| s.dot(v) < 20f32.to_radians().cos());
    let missing = (0..DIRECTIONS).map(direction::<f32>).filter(far).collect();
    let crosses = |name, directions: Vec<Vector3<f32>>, size: f64| Line {
        name,
        points: directions.iter().flat_map(|v| cross(v, size)).collect(),
    };
    Picture {
        title,
        x: "direction about y, from z towards x (°)",
        y: "above the x-z plane (°)",
        lines: vec![
            crosses("seen", seen.clone(), 0.5),
            crosses("missing", missing, 3.0),
        ],
    }
}

/// A cross on the map, and the pen up.
fn cross(v: &Vector3<f32>, size: f64) -> [[f64; 2]; 6] {
    let about = f64::from(v.x.atan2(v.z)).to_degrees();
    let above = f64::from(v.y.clamp(-1.0, 1.0).asin()).to_degrees();
    [
        [about - size, above],
        [about + size, above],
        [f64::NAN; 2],
        [about, above - size],
        [about, above + size],
        [f64::NAN; 2],
    ]
}

/// As the board would hear it: 1 kHz, counts at ±2000 °/s and ±16 g, a field every 10 ms.
fn recorded(text: &mut String, motion: &Chosen) -> Result<Vec<Heard>, fmt::Error> {
    writeln!(text, "{}", motion.describe())?;
    writeln!(text, "a recording has no temperature: 21 °C stands for it")?;
    let count = (motion.seconds * RATE) as usize;
    let heard = (0..count).map(|k| {
        let instant = motion.at(k as f64 / RATE);
        let sample = Sample {
            rate: AngularRate::from_rad_per_s(instant.rate.into()),
            force: SpecificForce::from_m_per_s2(instant.force.into()),
        };
        let field = instant.field.filter(|_| k % FIELD_EVERY == 0);
        Heard {
            raw: RANGES.counts::<f64>(&sample),
            field: field.map(|f| MagneticField::from_microtesla(Vector3::from(f).cast())),
        }
    });
    Ok(heard.collect())
}

/// A sensor with the faults that are printed, 3 s on each face and then turned for 90 s.
fn made_up(text: &mut String) -> Result<Vec<Heard>, fmt::Error> {
    let gyro_bias = AngularRate::from_dps(Vector3::new(1.2, -0.7, 0.4));
    let bias = SpecificForce::from_m_per_s2(Vector3::new(0.35, -0.22, 0.6));
    let reads = Vector3::<f64>::new(1.02, 0.985, 1.01);
    let hard_iron = Vector3::<f64>::new(31.0, -84.0, 12.5);
    let iron = Matrix3::<f64>::new(1.05, 0.02, -0.03, 0.02, 0.96, 0.01, -0.03, 0.01, 1.0);
    writeln!(text, "a made-up sensor with these faults:")?;
    row(text, "  gyro bias", gyro_bias.dps().cast(), "°/s")?;
    row(text, "  force bias", bias.m_per_s2().cast(), "m/s²")?;
    row(text, "  force scale", reads.map(f64::recip).cast(), "")?;
    row(text, "  hard iron", hard_iron.cast(), "µT")?;
    let soft_iron = iron.try_inverse().unwrap_or_default() * iron.determinant().cbrt();
    rows(text, "  soft iron", &soft_iron.cast())?;
    writeln!(text)?;
    let gyro = SimulatedTriad::new(
        MeasurementModel::aligned(gyro_bias),
        AngularRate::from_dps(Vector3::repeat(0.14)),
    );
    let accelerometer = SimulatedTriad::new(
        MeasurementModel::new(Matrix3::from_diagonal(&reads), bias),
        SpecificForce::from_m_per_s2(Vector3::repeat(0.043)),
    );
    let mut imu = SimulatedImu::new(gyro, accelerometer, RANGES, 1);
    let magnetometer = SimulatedTriad::new(
        MeasurementModel::new(iron, MagneticField::from_microtesla(hard_iron)),
        MagneticField::from_microtesla(Vector3::repeat(0.6)),
    );
    let mut noise = Gaussian::new(2);
    // 48 µT, 61° below the horizon to the north.
    let earth = Vector3::new(
        0.0,
        -48.0 * 61f64.to_radians().sin(),
        -48.0 * 61f64.to_radians().cos(),
    );
    let seconds = 18.0 + 90.0;
    let heard = (0..(seconds * RATE) as usize).map(|k| {
        let t = k as f64 / RATE;
        let (attitude, rate) = carried(t);
        let force = specific_force(attitude, Vector3::zeros());
        let field = MagneticField::from_microtesla(attitude.inverse() * earth);
        Heard {
            raw: imu.sample(AngularRate::from_rad_per_s(rate), force),
            field: (k % FIELD_EVERY == 0).then(|| {
                let field = magnetometer.measure(field, &mut noise).microtesla();
                MagneticField::from_microtesla(field.cast())
            }),
        }
    });
    Ok(heard.collect())
}

/// Body to world, and the rate in the body (rad/s).
fn carried(t: f64) -> (UnitQuaternion<f64>, Vector3<f64>) {
    let turn = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
    let (x, y, z) = (Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis());
    let quarter = TAU / 4.0;
    if t < 18.0 {
        // Set down by hand: two degrees off.
        let by_hand = turn(x, 0.02) * turn(z, -0.03);
        let face = match (t / 3.0) as u32 {
            0 => UnitQuaternion::identity(),
            1 => turn(z, quarter),
            2 => turn(z, -quarter),
            3 => turn(x, quarter),
            4 => turn(x, -quarter),
            _ => turn(x, 2.0 * quarter),
        };
        return (by_hand * face, Vector3::zeros());
    }
    // Round and round about one axis while that one tips over slowly, and both about the vertical.
    let at = |t: f64| turn(y, 0.31 * t) * turn(x, 0.17 * t) * turn(z, 1.3 * t);
    let step = 1e-4;
    let rate = (at(t - step).inverse() * at(t + step)).scaled_axis() / (2.0 * step);
    (at(t), rate)
}
