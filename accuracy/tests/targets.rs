//! How accurate the estimators have to be, on the recordings of the BROAD benchmark, and the scorer
//! beside the benchmark's own script. The recordings and the script are not kept here: without them
//! these tests show as ignored, with what they miss.

#[path = "recording/mod.rs"]
mod recording;

use std::path::PathBuf;
use std::process::{Command, ExitCode};

use libtest_mimic::{Arguments, Completion, Failed, Trial as Test};
use recording::folder;
use vrduino_accuracy::estimators::{self, Axes, Estimator};
use vrduino_accuracy::evaluation::{run, scores};
use vrduino_accuracy::report;
use vrduino_accuracy::score::Score;
use vrduino_accuracy::trial::Trial;
use vrduino_accuracy::variant::Variant;

type Outcome = Result<Completion, Failed>;

const NO_RECORDINGS: &str = "needs VRDUINO_MOTIONS, a folder of the benchmark's recordings";
const NO_SCRIPT: &str =
    "needs VRDUINO_SCORER, the benchmark's scorer as a Python script, with numpy";

fn trials() -> Option<Vec<Trial>> {
    let folder = PathBuf::from(std::env::var_os("VRDUINO_MOTIONS")?);
    Some(Trial::open_all(&folder).expect("VRDUINO_MOTIONS names a folder of recordings"))
}

fn estimator(name: &str, axes: Axes) -> Estimator {
    let mut ours = estimators::ours().into_iter();
    ours.find(|estimator| estimator.name == name && estimator.axes == axes)
        .expect("there is such an estimator")
}

fn all_scores(name: &str, axes: Axes, trials: &[Trial], variant: Variant) -> Vec<Score> {
    scores(&run(&[estimator(name, axes)], trials, variant)).remove(0)
}

/// Name, axes, variant, the figure and the most it may be (°).
type Target = (&'static str, Axes, Variant, fn(&[Score]) -> f64, f64);

fn inclination(scores: &[Score]) -> f64 {
    Score::mean(scores).inclination
}

fn worst_inclination(scores: &[Score]) -> f64 {
    scores
        .iter()
        .map(|score| score.inclination)
        .fold(0.0, f64::max)
}

fn total(scores: &[Score]) -> f64 {
    Score::mean(scores).total
}

#[rustfmt::skip] // one target per line
const TARGETS: [Target; 13] = [
    ("vrduino", Axes::Six, Variant::AsRecorded, inclination, 0.74),
    ("vrduino", Axes::Six, Variant::AsRecorded, worst_inclination, 1.65),
    ("vrduino, 2.5 ms lead", Axes::Six, Variant::AsRecorded, inclination, 0.57),
    ("vrduino, f32", Axes::Six, Variant::AsRecorded, inclination, 0.74),
    ("vrduino", Axes::Six, Variant::Registers, inclination, 0.74),
    ("vrduino", Axes::Six, Variant::Biased, inclination, 0.735),
    ("vrduino", Axes::Six, Variant::ColdStart, inclination, 1.40),
    ("vrduino", Axes::Six, Variant::ThirdOfTheRate, inclination, 0.92),
    ("vrduino", Axes::Nine, Variant::AsRecorded, total, 2.17),
    ("vrduino, f32", Axes::Nine, Variant::AsRecorded, total, 2.17),
    ("vrduino", Axes::Nine, Variant::Registers, total, 2.17),
    ("vrduino", Axes::Nine, Variant::ColdStart, total, 5.0),
    ("vrduino", Axes::Nine, Variant::ColdStart, inclination, 1.40),
];

fn targets_are_met() -> Outcome {
    let Some(trials) = trials() else {
        return Ok(Completion::ignored_with(NO_RECORDINGS));
    };
    let mut missed = Vec::new();
    for (name, axes, variant, figure, most) in TARGETS {
        let found = figure(&all_scores(name, axes, &trials, variant));
        println!("{name} {axes:?} {variant:?}: {found:.3}°, at most {most}°");
        if found.is_nan() || found > most {
            missed.push(format!(
                "{name} {axes:?} {variant:?}: {found:.3}°, not {most}°"
            ));
        }
    }
    if missed.is_empty() {
        return Ok(Completion::Completed);
    }
    Err(missed.join("\n").into())
}

fn the_scorer_is_the_benchmarks() -> Outcome {
    let Some(trials) = trials() else {
        return Ok(Completion::ignored_with(NO_RECORDINGS));
    };
    let Some(script) = std::env::var_os("VRDUINO_SCORER") else {
        return Ok(Completion::ignored_with(NO_SCRIPT));
    };
    for axes in [Axes::Six, Axes::Nine] {
        let estimators = [estimator("vrduino", axes)];
        let outcomes = run(&estimators, &trials, Variant::AsRecorded);
        let folder = folder(&[]);
        report::results(folder.path(), &trials, &estimators, &outcomes)?;
        let mut inside = std::fs::read_dir(folder.path())?;
        let results = inside.next().expect("one estimator")?.path();
        let output = Command::new("python3")
            .arg(&script)
            .arg(&results)
            .arg("--trials")
            .arg(std::env::var_os("VRDUINO_MOTIONS").unwrap_or_default())
            .arg("--per-trial")
            .output()?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
        }
        for (trial, outcome) in trials.iter().zip(&outcomes[0]) {
            let line = text.lines().find(|line| line.starts_with(&trial.name));
            let line = line.ok_or_else(|| format!("{}: not in\n{text}", trial.name))?;
            let words = line.split_whitespace().skip(1);
            let theirs: Vec<f64> = words.map(str::parse).collect::<Result<_, _>>()?;
            let Score {
                inclination,
                heading,
                total,
                aligned,
            } = outcome.score;
            for (ours, theirs) in [inclination, heading, total, aligned].iter().zip(&theirs) {
                // They print three decimals of results in single precision.
                if (ours - theirs).abs() > 0.001 {
                    return Err(format!("{}: {ours} here, {theirs} there", trial.name).into());
                }
            }
        }
    }
    Ok(Completion::Completed)
}

fn main() -> ExitCode {
    let mut arguments = Arguments::from_args();
    // What is missing is told by the tests themselves.
    arguments.include_ignored = false;
    let tests = vec![
        Test::ignorable_test("targets_are_met", targets_are_met),
        Test::ignorable_test("the_scorer_is_the_benchmarks", the_scorer_is_the_benchmarks),
    ];
    libtest_mimic::run(&arguments, tests).exit_code()
}
