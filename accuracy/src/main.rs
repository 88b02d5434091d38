//! `cargo accuracy DIR`.

use std::error::Error;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use vrduino_accuracy::trial::Trial;
use vrduino_accuracy::variant::Variant;
use vrduino_accuracy::{estimators, evaluation, report};

/// Runs every estimator on a folder of recorded motions and prints how far off it was.
///
/// The metric is that of the BROAD benchmark: root mean square error while moving, in degrees, and its mean over
/// the trials. One set of parameters for all trials; no estimator is led unless its name says so.
#[derive(Parser)]
#[command(name = "cargo accuracy", version)]
struct Arguments {
    /// A folder of .imub recordings with an optical reference (the format is in emulator/README.md)
    #[arg(value_name = "DIR")]
    recordings: PathBuf,

    /// Write here: a folder per estimator with a .q32 file per trial, and pictures of error over time
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Print the benchmark's groups too
    #[arg(long)]
    groups: bool,

    /// Print each trial too
    #[arg(long)]
    trials: bool,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        // A reader that has seen enough is no fault.
        Err(error)
            if error
                .downcast_ref::<io::Error>()
                .is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe) =>
        {
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let trials = Trial::open_all(&arguments.recordings)?;
    if let Some(folder) = &arguments.out {
        report::create(folder)?;
    }
    let estimators = estimators::all();
    let mut out = io::stdout().lock();
    writeln!(
        out,
        "{} recordings, {:.0} s; input: the files' own counts, scaled to the peak of each file",
        trials.len(),
        trials
            .iter()
            .map(|trial| trial.period * trial.samples.len() as f64)
            .sum::<f64>()
    )?;
    let mut columns = Vec::new();
    for variant in Variant::ALL {
        let outcomes = evaluation::run(&estimators, &trials, variant);
        if variant == Variant::AsRecorded {
            report::summary(&mut out, &estimators, &outcomes)?;
            if arguments.groups {
                report::groups(&mut out, &trials, &estimators, &outcomes)?;
            }
            if arguments.trials {
                report::per_trial(&mut out, &trials, &estimators, &outcomes)?;
            }
            if let Some(folder) = &arguments.out {
                report::results(folder, &trials, &estimators, &outcomes)?;
                report::pictures(&folder.join("pictures"), &trials, &estimators, &outcomes)?;
            }
        }
        columns.push((variant, evaluation::scores(&outcomes)));
    }
    report::variants(&mut out, &estimators, &columns)?;
    writeln!(
        out,
        "recorded: the files' counts; registers: as ±2000 °/s, ±16 g and 0.15 µT would hold them; 1/3 and 1/6 rate: \
         means of\nthree and six samples; +1 °/s: on every axis of the gyro, at rest at the start; cold: that, and cut 1 s before the \
         first motion."
    )?;
    if let Some(folder) = &arguments.out {
        writeln!(out, "results and pictures are in {}", folder.display())?;
    }
    Ok(())
}
