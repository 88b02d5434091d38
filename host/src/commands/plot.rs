//! `vrduino plot`: a recording as a picture, to be printed.

mod curve;

mod drawing;

mod figure;

mod gaps;

mod raster;

mod rate;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;

use crate::failure::{Failure, Kind};
use crate::recording::Reader;
use figure::Figure;

const EXAMPLES: &str = "\
Examples:
  vrduino plot desk.csv               into desk.svg
  vrduino plot desk.csv -o desk.png   2400 by 1600 pixels

Yaw is unwrapped: it goes on beyond 180 degrees. Gaps are shaded; a line marks where the board \
or the connection began anew.";

/// What is asked for.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// A recording of `vrduino record`
    pub file: PathBuf,
    /// Into this file: *.svg or *.png; without it, the recording's name with .svg
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Draws it.
///
/// # Errors
///
/// The recording cannot be read, holds no sample, or the picture cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let output = match &arguments.output {
        Some(path) => path.clone(),
        None => arguments.file.with_extension("svg"),
    };
    let draw = format(&output)?;
    let mut reader = Reader::open(&arguments.file)?;
    let figure = Figure::of(&arguments.file, &mut reader);
    if let Some(warning) = reader.warning() {
        // Where nobody can read it, it need not be said; here and below.
        let _ = writeln!(io::stderr(), "{warning}");
    }
    let picture = draw(&figure?)?;
    fs::write(&output, picture).map_err(|error| {
        // Half a picture is none. A device stays.
        if output.is_file() {
            let _ = fs::remove_file(&output);
        }
        let sentence = format!("{} cannot be written: {error}", output.display());
        Failure::new(Kind::File, sentence)
    })?;
    let _ = writeln!(io::stdout(), "{}", output.display());
    Ok(())
}

type Draw = fn(&Figure) -> Result<Vec<u8>, Failure>;

fn format(path: &Path) -> Result<Draw, Failure> {
    let ending = path.extension().and_then(|ending| ending.to_str());
    match ending.map(str::to_ascii_lowercase).as_deref() {
        Some("svg") => Ok(drawing::svg),
        Some("png") => Ok(raster::png),
        _ => Err(Failure::new(
            Kind::File,
            format!(
                "{} is no picture: give -o a name that ends in .svg or .png",
                path.display()
            ),
        )),
    }
}
