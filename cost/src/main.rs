//! `cargo cost`.

use std::error::Error;
use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::thread;

use clap::Parser;
use vrduino_cost::subject::{OURS, PEERS, Program, YARDSTICK};
use vrduino_cost::table::{self, Row};
use vrduino_cost::{count, firmware};
use vrduino_emulator::firmware as tracker;
use vrduino_emulator::firmware::BuildOptions;

/// Counts on the emulated chip what an update of each filter costs, and what the tracker does from the sensor to USB.
///
/// Counts are exact: two runs print the same. A cycle takes 1/72 us; the band of cycles is what the manuals leave open.
#[derive(Parser)]
#[command(name = "cargo cost", version)]
struct Arguments {
    /// Write the figures here too; cost/README.md says how
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Print where the instructions of one filter go, by the name it has in the JSON, and nothing else
    #[arg(long, value_name = "NAME", conflicts_with_all = ["json", "ours"])]
    profile: Option<String>,

    /// Leave out the filters of others, which take most of the time
    #[arg(long)]
    ours: bool,
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
    if let Some(name) = &arguments.profile {
        return profile(name);
    }
    let mut rows = rows(&OURS)?;
    if !arguments.ours {
        let peers = self::rows(&PEERS).map_err(|error| {
            format!("{error}\n`cargo cost --ours` does without the filters of others")
        })?;
        rows.extend(peers);
    }
    let yardstick = rows
        .iter()
        .find(|row| row.subject.name == YARDSTICK)
        .map_or(f64::NAN, |row| row.count.mean());
    let mut out = io::stdout().lock();
    table::filters(&mut out, &rows, yardstick)?;
    writeln!(out)?;

    let image = tracker::build(BuildOptions { quiet: true })?;
    let figures = at_once(&firmware::MODES, |mode| firmware::run(&image, mode))?;
    let runs: Vec<_> = firmware::MODES.into_iter().zip(figures).collect();
    table::firmware(&mut out, &runs)?;

    if let Some(path) = &arguments.json {
        let json = table::json(&rows, yardstick, &runs);
        fs::write(path, format!("{json}\n")).map_err(|error| {
            format!(
                "cannot write {}: {error}; name a file in a folder that exists",
                path.display()
            )
        })?;
    }
    Ok(())
}

/// Functions of a profile that are told.
const PROFILE_ROWS: usize = 20;

fn profile(name: &str) -> Result<(), Box<dyn Error>> {
    let programs = [OURS, PEERS];
    let mut all = programs.iter().flat_map(|program| {
        program
            .subjects
            .iter()
            .map(move |subject| (program, subject))
    });
    let Some((program, subject)) = all.clone().find(|(_, subject)| subject.name == name) else {
        let names: Vec<_> = all.by_ref().map(|(_, subject)| subject.name).collect();
        return Err(format!("no filter is called {name}; there are {}", names.join(", ")).into());
    };
    let functions = count::profile(&program.build()?, subject)?;
    let mut out = io::stdout().lock();
    writeln!(out, "instructions of a sample: {}", subject.label)?;
    for (function, instructions) in functions.iter().take(PROFILE_ROWS) {
        writeln!(out, "{instructions:>10.1}  {function}")?;
    }
    Ok(())
}

/// Counts all filters of a program.
fn rows(program: &Program) -> Result<Vec<Row>, Box<dyn Error>> {
    let image = program.build()?;
    let counts = at_once(program.subjects, |subject| count::count(&image, subject))?;
    let subjects = program.subjects.iter().zip(counts);
    Ok(subjects
        .map(|(subject, count)| {
            let reference = subject.reference.orientations();
            Row {
                subject: *subject,
                error: reference.map(|reference| count.error(&reference)),
                count,
            }
        })
        .collect())
}

/// Does `work` with each of these, each on a board of its own and so on a thread of its own.
fn at_once<T: Sync, R: Send>(
    all: &[T],
    work: impl Fn(&T) -> Result<R, Box<dyn Error>> + Sync,
) -> Result<Vec<R>, Box<dyn Error>> {
    let work = &work;
    thread::scope(|scope| {
        let running: Vec<_> = all
            .iter()
            .map(|one| scope.spawn(move || work(one).map_err(|error| error.to_string())))
            .collect();
        running
            .into_iter()
            .map(|thread| Ok(thread.join().map_err(|_| "a board failed; see above")??))
            .collect()
    })
}
