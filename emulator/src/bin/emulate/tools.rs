//! Options for looking into a run.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use vrduino_emulator::board::Board;
use vrduino_emulator::gdb;
use vrduino_emulator::time;
use vrduino_emulator::trace::{Topic, Trace};
use vrduino_emulator::vcd::Vcd;

use super::Error;
use super::say;
use super::tcp::TcpPort;
use crate::values::positive;

/// What is written down about the run.
#[derive(Args, Debug)]
#[command(next_help_heading = "Looking into a run")]
pub struct Tools {
    /// Tell in words what happens: registers, i2c, usb, interrupts, or all; several with commas between
    #[arg(long, value_name = "WHAT", value_delimiter = ',', value_parser = topic)]
    pub trace: Vec<Traced>,

    /// Begin the trace at this time, in seconds
    #[arg(long, value_name = "S", default_value = "0", value_parser = positive, requires = "trace")]
    pub trace_from: f64,

    /// End the trace at this time, in seconds
    #[arg(long, value_name = "S", value_parser = positive, requires = "trace")]
    pub trace_until: Option<f64>,

    /// Write the trace to this file instead of standard error
    #[arg(long, value_name = "FILE", requires = "trace")]
    pub trace_file: Option<PathBuf>,

    /// Count load, bus, latency and profile from this time on, in seconds
    #[arg(long, value_name = "S", default_value = "0", value_parser = positive)]
    pub measure_from: f64,

    /// Tell where the time goes, by function
    #[arg(long)]
    pub profile: bool,

    /// Write the lines of the sensor bus and of USB, sleep and interrupts to this file, for GTKWave
    #[arg(long, value_name = "FILE")]
    pub vcd: Option<PathBuf>,

    /// Let a debugger in on this port of 127.0.0.1, and wait for it before the first instruction; 0 is any free port,
    /// which is printed
    #[arg(long, value_name = "PORT")]
    pub gdb: Option<u16>,

    /// The stream on this TCP port of 127.0.0.1 as well, both ways; 0 is any free port, which is printed
    #[arg(long, value_name = "PORT")]
    pub tcp: Option<u16>,

    /// Write down what comes from outside, and when, to repeat the run with --replay
    #[arg(long, value_name = "FILE", conflicts_with_all = ["gdb", "replay", "usbip"])]
    pub record: Option<PathBuf>,

    /// Repeat a run that was written down with --record; image, motion and options have to be the same
    #[arg(long, value_name = "FILE", conflicts_with_all = ["gdb", "typed", "fault", "seconds", "usbip"])]
    pub replay: Option<PathBuf>,
}

/// One topic, or all.
#[derive(Debug, Clone, Copy)]
pub struct Traced(Option<Topic>);

fn topic(text: &str) -> Result<Traced, String> {
    if text == "all" {
        return Ok(Traced(None));
    }
    text.parse().map(|topic| Traced(Some(topic)))
}

impl Tools {
    /// The door for a debugger, if one is wanted.
    pub fn debugger(&self) -> Result<Option<gdb::Server>, Error> {
        let Some(port) = self.gdb else {
            return Ok(None);
        };
        let server = gdb::Server::open(port).map_err(|error| taken(port, &error))?;
        say!("gdb     target remote {}", server.address()?);
        Ok(Some(server))
    }

    /// The stream's TCP port, if one is wanted.
    pub fn tcp_port(&self) -> Result<Option<TcpPort>, Error> {
        let Some(port) = self.tcp else {
            return Ok(None);
        };
        let door = TcpPort::open(port).map_err(|error| taken(port, &error))?;
        say!("tcp     {}", door.address()?);
        Ok(Some(door))
    }

    /// Begins to measure once it is time; `begun` tells whether it has begun.
    pub fn measure(&self, board: &mut Board, begun: &mut bool) {
        if !*begun && board.now() >= time::ticks(self.measure_from) {
            *begun = true;
            board.begin_figures();
            if self.profile {
                board.profile();
            }
        }
    }

    /// Lets everything that is wanted watch the board.
    pub fn watch(&self, board: &mut Board) -> Result<(), Error> {
        if !self.trace.is_empty() {
            if self
                .trace_until
                .is_some_and(|until| until <= self.trace_from)
            {
                return Err(
                    "the trace has to end after it begins: give --trace-until a later time".into(),
                );
            }
            let topics: Vec<Topic> = if self.trace.iter().any(|traced| traced.0.is_none()) {
                Topic::ALL.to_vec()
            } else {
                self.trace.iter().filter_map(|traced| traced.0).collect()
            };
            let out: Box<dyn Write + Send> = match &self.trace_file {
                Some(path) => Box::new(create(path)?),
                None => Box::new(BufWriter::new(io::stderr())),
            };
            let from = time::ticks(self.trace_from);
            let until = self.trace_until.map_or(time::NEVER, time::ticks);
            board.watch(Box::new(Trace::new(out, &topics, from, until)));
        }
        if let Some(path) = &self.vcd {
            let dump = Vcd::new(create(path)?).map_err(|error| in_file(path, &error))?;
            board.watch(Box::new(dump));
        }
        Ok(())
    }
}

fn create(path: &Path) -> Result<BufWriter<File>, Error> {
    File::create(path)
        .map(BufWriter::new)
        .map_err(|error| in_file(path, &error))
}

fn in_file(path: &Path, error: &io::Error) -> Error {
    format!("{} cannot be written: {error}", path.display()).into()
}

/// What to say of a port of this computer that cannot be opened.
fn taken(port: u16, error: &io::Error) -> Error {
    format!(
        "port {port} of 127.0.0.1 cannot be opened: {error}; give another, or 0 for any free one"
    )
    .into()
}
