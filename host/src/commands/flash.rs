//! `vrduino flash`: puts the tracker's program on the board, and hears from the board that it runs.

mod image;

mod loader;

mod reboot;

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use crate::board;
use crate::computer::{halfkay, programs};
use crate::failure::{Failure, Kind};
use crate::interrupt::Interrupt;
use crate::output::Output;
use crate::source::{Choice, port};
pub use loader::{LOADER, WHERE_TO_GET_IT};

/// How long the board may take to come back: it enumerates in a second, and ModemManager may look at it.
const RETURN: Duration = Duration::from_secs(15);

const MEANING: &str = "\
The board is asked to go into its loader (the port is opened at 134 baud); one that does not know that is sent there by \
the button on it. Then PJRC's teensy_loader_cli writes the image, and the board is asked `:version`. An image that would not \
start, or would lock the board for good, is refused before anything is touched.";

/// What is asked for.
#[derive(Clone, Debug, Args)]
#[command(after_help = MEANING)]
pub struct Arguments {
    /// What is written, Intel HEX or ELF, in the place of this repository's firmware
    #[arg(long, value_name = "FILE")]
    pub hex: Option<PathBuf>,
    /// The board's serial port, as `vrduino list` names it
    #[arg(long, value_name = "PORT")]
    pub port: Option<String>,
    /// Builds and judges the image, and says what would be done
    #[arg(long)]
    pub dry_run: bool,
}

/// Flashes.
///
/// # Errors
///
/// The image is refused, the loader is missing or fails, or the board does not come back.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut output = Output::new();
    if arguments
        .port
        .as_ref()
        .is_some_and(|port| port.starts_with("tcp:"))
    {
        return Err(Failure::new(
            Kind::Board,
            "a board behind tcp: has no loader: name a serial port, or plug the board in here",
        ));
    }
    let image = image::prepare(arguments.hex.as_deref())?;
    output.say(format!("the image is sound: {}", image.summary));
    let loader = programs::installed(LOADER);
    let port = port(arguments.port.as_deref())?;
    if arguments.dry_run {
        dry(&mut output, &image, loader.is_some(), port.as_deref());
        return Ok(());
    }
    let loader = loader.ok_or_else(|| {
        let sentence = format!("{LOADER} is not in PATH. {WHERE_TO_GET_IT}");
        Failure::new(Kind::Computer, sentence)
    })?;
    let interrupt = Interrupt::listen();
    match &port {
        Some(name) => {
            reboot::into_loader(name)?;
            output.say(format!("{name} was asked to go into its loader"));
        }
        None if halfkay::waiting() > 0 => output.say("a Teensy waits in its loader"),
        None => {
            output.say("no board's port is there: plug the board in and press the button on it")
        }
    }
    loader::write(&loader, &image.hex, &interrupt)?;
    let version = return_of(arguments.port.clone())?;
    judge(version, arguments.hex.is_some(), &mut output)
}

/// The port of the board, if it shows as one.
fn port(name: Option<&str>) -> Result<Option<String>, Failure> {
    match name {
        Some(name) => Ok(Some(name.to_owned())),
        None => {
            let boards = port::boards()?;
            match boards.len() {
                0 => Ok(None),
                // More are a question for the user.
                _ => port::find().map(|found| Some(found.name)),
            }
        }
    }
}

fn dry(output: &mut Output, image: &image::Prepared, has_loader: bool, port: Option<&str>) {
    match port {
        Some(name) => output.say(format!(
            "would open {name} at 134 baud: the board goes into its loader"
        )),
        None => output.say("would ask for the button on the board: its port is not there"),
    }
    let arguments = loader::arguments(&image.hex);
    let arguments: Vec<_> = arguments
        .iter()
        .map(|word| word.to_string_lossy())
        .collect();
    output.say(format!("would run {LOADER} {}", arguments.join(" ")));
    if !has_loader {
        output.say(format!("but {LOADER} is not in PATH. {WHERE_TO_GET_IT}"));
    }
}

/// Who the board says it is.
fn return_of(port: Option<String>) -> Result<Option<String>, Failure> {
    board::greet(Choice::Port(port), RETURN).map_err(|failure| {
        let sentence = format!(
            "the image is written, but the board has not come back: {failure}; plug it in again, and see `vrduino doctor`"
        );
        Failure::new(failure.kind, sentence)
    })
}

fn judge(version: Option<String>, foreign: bool, output: &mut Output) -> Result<(), Failure> {
    match version {
        Some(version) => {
            output.say(format!("the board is back and says it is {version}"));
            Ok(())
        }
        None if foreign => {
            output.say(
                "the board is back; its program answers no `:version`, so it is not the tracker's",
            );
            Ok(())
        }
        None => Err(Failure::new(
            Kind::Stream,
            "the image is written and the board is back, but it does not answer `:version`: unplug it, plug it in again, and see `vrduino doctor`",
        )),
    }
}
