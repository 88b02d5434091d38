//! The default estimator in fixed point beside the one in double precision, on the recordings of the BROAD
//! benchmark. They are not kept here: without them these tests show as ignored, with what they miss.

use std::path::PathBuf;
use std::process::ExitCode;

use libtest_mimic::{Arguments, Completion, Failed, Trial as Test};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use vrduino::fixed::fusion::{Field, Nanoseconds, Rates};
use vrduino::fixed::{self, fusion};
use vrduino::fusion::{Fusion, Parameters, Rates as Periods};
use vrduino::imu::RANGES;
use vrduino::sensor::{RawSample, Sample};
use vrduino::units::{AngularRate, MagneticField, Seconds, SpecificForce};
use vrduino_accuracy::estimators::Axes;
use vrduino_accuracy::trial::{NineAxes, Trial};

type Outcome = Result<Completion, Failed>;

const NO_RECORDINGS: &str = "needs VRDUINO_MOTIONS, a folder of the benchmark's recordings";

/// What a sensor on the board would have reported.
struct Recording {
    name: String,
    period: Nanoseconds,
    samples: Vec<(RawSample, [i32; 3])>,
}

/// µT as a field in fixed point.
fn parts(field: MagneticField<f64>) -> [i32; 3] {
    field
        .microtesla()
        .map(|part| (part * 32768.0).round() as i32)
        .into()
}

fn counted(axes: &NineAxes) -> (RawSample, [i32; 3]) {
    (RANGES.counts(&axes.sample), parts(axes.field))
}

fn as_recorded(trial: &Trial) -> Recording {
    Recording {
        name: trial.name.clone(),
        period: Nanoseconds((trial.period * 1e9).round() as u32),
        samples: trial.samples.iter().map(counted).collect(),
    }
}

/// On the straight lines between the samples.
fn at_1_khz(trial: &Trial) -> Recording {
    let period = Nanoseconds(1_000_000);
    let seconds = (trial.samples.len() - 1) as f64 * trial.period;
    let samples = (0..(seconds * 1000.0) as usize).map(|millisecond| {
        let at = millisecond as f64 / 1000.0 / trial.period;
        let index = (at as usize).min(trial.samples.len() - 2);
        let [before, after] = [trial.samples[index], trial.samples[index + 1]];
        let between = |a: Vector3<f64>, b: Vector3<f64>| a.lerp(&b, at - index as f64);
        let rate = between(
            before.sample.rate.rad_per_s(),
            after.sample.rate.rad_per_s(),
        );
        let force = between(
            before.sample.force.m_per_s2(),
            after.sample.force.m_per_s2(),
        );
        let field = between(before.field.microtesla(), after.field.microtesla());
        counted(&NineAxes {
            sample: Sample {
                rate: AngularRate::from_rad_per_s(rate),
                force: SpecificForce::from_m_per_s2(force),
            },
            field: MagneticField::from_microtesla(field),
        })
    });
    Recording {
        name: trial.name.clone(),
        period,
        samples: samples.collect(),
    }
}

/// The largest angle between the two, in degrees: in the compass's first ten seconds, and after.
fn largest_differences(recording: &Recording, axes: Axes) -> [f64; 2] {
    let period = recording.period;
    let seconds = Seconds(f64::from(period.0) * 1e-9);
    let mut reference = Fusion::<f64>::new(
        &Parameters::default(),
        Periods {
            sample: seconds,
            field: seconds,
        },
    );
    let mut fixed = fixed::fusion::Fusion::new(
        &fusion::Parameters::default(),
        Rates {
            sample: period,
            field: period,
            ranges: RANGES,
        },
    );
    let mut largest = [0.0_f64; 2];
    for (number, (raw, field)) in recording.samples.iter().enumerate() {
        let nine = axes == Axes::Nine;
        let microtesla = Vector3::from(field.map(|part| f64::from(part) / 32768.0));
        let field_as_read = MagneticField::from_microtesla(microtesla);
        reference.update(&RANGES.sample(raw), nine.then_some(field_as_read));
        fixed.update(raw, nine.then(|| Field::from_parts_of_microtesla(*field)));
        let [w, x, y, z] = fixed
            .bits()
            .map(|bits| f64::from(bits) / f64::from(1 << 30));
        let found = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let apart = (reference.orientation().inverse() * found).imag().norm();
        let degrees = 2.0 * apart.min(1.0).asin().to_degrees();
        let late = usize::from(number as f64 * seconds.0 > 10.0);
        largest[late] = largest[late].max(degrees);
    }
    largest
}

/// Over all recordings: at most so much (°) at the start, and after.
fn follows(axes: Axes, of: fn(&Trial) -> Recording, most: [f64; 2]) -> Outcome {
    let Some(folder) = std::env::var_os("VRDUINO_MOTIONS") else {
        return Ok(Completion::ignored_with(NO_RECORDINGS));
    };
    let trials = Trial::open_all(&PathBuf::from(folder))?;
    let mut missed = Vec::new();
    for trial in &trials {
        let recording = of(trial);
        let [start, after] = largest_differences(&recording, axes);
        let line = format!(
            "{axes:?} {}: {start:.6}° at the start, {after:.6}° after",
            recording.name
        );
        println!("{line}");
        if !(start <= most[0] && after <= most[1]) {
            missed.push(line);
        }
    }
    if missed.is_empty() {
        return Ok(Completion::Completed);
    }
    Err(missed.join("\n").into())
}

fn main() -> ExitCode {
    let mut arguments = Arguments::from_args();
    // What is missing is told by the tests themselves.
    arguments.include_ignored = false;
    let test = |name: &str, axes, of: fn(&Trial) -> Recording, most| {
        Test::ignorable_test(name, move || follows(axes, of, most))
    };
    let tests = vec![
        test(
            "six_axes_as_recorded",
            Axes::Six,
            as_recorded,
            [0.002, 0.002],
        ),
        test("six_axes_at_1_khz", Axes::Six, at_1_khz, [0.002, 0.002]),
        test(
            "nine_axes_as_recorded",
            Axes::Nine,
            as_recorded,
            [0.01, 0.004],
        ),
        test("nine_axes_at_1_khz", Axes::Nine, at_1_khz, [0.01, 0.004]),
    ];
    libtest_mimic::run(&arguments, tests).exit_code()
}
