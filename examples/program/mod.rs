//! What all examples share as programs: `--help`, errors, and output that a reader may cut short.

use std::error::Error;
use std::io::{self, Write};
use std::process::ExitCode;

/// Runs an example that takes so many arguments. `source` is its own text, whose first comment
/// answers `--help`. What it finds goes into a text that is printed at the end, so that of an
/// example that fails there is nothing but the error.
pub fn run(
    source: &str,
    arguments: usize,
    example: impl FnOnce(&mut String) -> Result<(), Box<dyn Error>>,
) -> ExitCode {
    let mut text = String::new();
    let mut given = std::env::args_os().skip(1);
    let done = if given.by_ref().any(|argument| argument == "--help") {
        text = about(source);
        Ok(())
    } else if std::env::args_os().skip(1).count() > arguments {
        Err(match arguments {
            0 => "there is no argument but --help",
            _ => "there is no argument but one recording, or --help",
        }
        .into())
    } else {
        example(&mut text)
    };
    let shown = done.and_then(|()| Ok(io::stdout().lock().write_all(text.as_bytes())?));
    finish(shown)
}

/// The program's end. A pipe that is closed early has shown all that was asked for.
fn finish(outcome: Result<(), Box<dyn Error>>) -> ExitCode {
    let Err(error) = outcome else {
        return ExitCode::SUCCESS;
    };
    let closed = error.downcast_ref::<io::Error>();
    if closed.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe) {
        return ExitCode::SUCCESS;
    }
    eprintln!("error: {error}");
    ExitCode::FAILURE
}

/// The comment that a source begins with.
fn about(source: &str) -> String {
    let lines = source.lines().map_while(|line| line.strip_prefix("//!"));
    lines
        .map(|line| line.strip_prefix(' ').unwrap_or(line).to_owned() + "\n")
        .collect()
}
