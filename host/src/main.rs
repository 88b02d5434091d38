//! `vrduino`: see `vrduino --help`.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{CommandFactory, Parser};
use vrduino_host::cli::{Arguments, Command};
use vrduino_host::commands;
use vrduino_host::failure::{Failure, Kind};

fn main() -> ExitCode {
    let result = match &Arguments::parse().command {
        Command::View(arguments) => commands::view::run(arguments),
        #[cfg(feature = "tui")]
        Command::Tui(arguments) => commands::tui::run(arguments),
        Command::Serve(arguments) => commands::serve::run(arguments),
        Command::List(arguments) => commands::list::run(arguments),
        Command::Monitor(arguments) => commands::monitor::run(arguments),
        Command::Record(arguments) => commands::record::run(arguments),
        Command::Replay(arguments) => commands::replay::run(arguments),
        #[cfg(feature = "plot")]
        Command::Plot(arguments) => commands::plot::run(arguments),
        Command::Calibrate(arguments) => commands::calibrate::run(arguments),
        Command::Flash(arguments) => commands::flash::run(arguments),
        Command::Doctor(arguments) => commands::doctor::run(arguments),
        Command::Completions { shell } => complete(*shell),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => say(&failure),
    }
}

fn say(failure: &Failure) -> ExitCode {
    // Where nobody can read it, the exit code has to do.
    let _ = writeln!(io::stderr(), "vrduino: {failure}");
    failure.exit_code()
}

fn complete(shell: clap_complete::Shell) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "vrduino", &mut script);
    let mut output = io::stdout().lock();
    match output.write_all(&script).and_then(|()| output.flush()) {
        // Whoever reads it may have seen enough.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            let sentence = format!("standard output cannot be written to: {error}");
            Err(Failure::new(Kind::File, sentence))
        }
        _ => Ok(()),
    }
}
