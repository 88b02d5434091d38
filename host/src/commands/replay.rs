//! `vrduino replay`: a recording as a stream again, for other programs.

mod server;

use std::io::{self, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;

use crate::arguments;
use crate::failure::{Failure, Kind};
use crate::interrupt::Interrupt;
use crate::recording::{Format, Player, encode};
use server::Server;

const EXAMPLES: &str = "\
Examples:
  vrduino replay desk.csv                       its lines, as they came
  vrduino replay desk.csv --speed 10 --repeat   ten times as fast, without end
  vrduino replay desk.csv --stream binary --tcp 5000
  vrduino monitor --port tcp:127.0.0.1:5000     elsewhere: what that serves

To see it, `vrduino view --replay desk.csv`; `tui`, `serve`, `monitor` and `record` read one so too.";

/// What is asked for.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// A recording of `vrduino record`
    pub file: PathBuf,
    /// So many times as fast as it came
    #[arg(
        long,
        value_name = "TIMES",
        default_value_t = 1.0,
        value_parser = arguments::within(arguments::SPEEDS, "times"),
        allow_negative_numbers = true,
    )]
    pub speed: f64,
    /// When it is over it begins again
    #[arg(long)]
    pub repeat: bool,
    /// How an orientation is sent
    #[arg(long, value_name = "STREAM", value_enum, default_value_t)]
    pub stream: Format,
    /// On this TCP port of 127.0.0.1, to any number of programs, in the place of standard output; it begins with
    /// the first of them. 0 is any free port, which is printed
    #[arg(long, value_name = "PORT")]
    pub tcp: Option<u16>,
}

/// Plays it until its end, or Ctrl-C.
///
/// # Errors
///
/// It cannot be read, or the port is taken.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    // What cannot be read is told before anybody is waited for.
    let mut player = Player::open(&arguments.file, arguments.speed)?;
    let interrupt = Interrupt::listen();
    let mut output = match arguments.tcp {
        Some(port) => Output::Tcp(Server::open(port)?),
        None => Output::Standard(io::stdout()),
    };
    if let Output::Tcp(server) = &mut output {
        say(&format!("tcp     {}", server.address()));
        while !server.has_clients() && !interrupt.has_come() {
            std::thread::sleep(Duration::from_millis(20));
        }
    }
    loop {
        let went_on = play(&mut player, arguments.stream, &mut output, &interrupt)?;
        let is_empty = player.is_empty();
        if !went_on || !arguments.repeat || is_empty {
            return Ok(());
        }
        player = Player::open(&arguments.file, arguments.speed)?;
    }
}

/// Once from the beginning to the end; whether it got there.
fn play(
    player: &mut Player,
    format: Format,
    output: &mut Output,
    interrupt: &Interrupt,
) -> Result<bool, Failure> {
    /// Ctrl-C is not waited for longer.
    const NAP: Duration = Duration::from_millis(50);
    let began = Instant::now();
    let mut bytes = Vec::new();
    while let Some(batch) = player.next_batch()? {
        loop {
            if interrupt.has_come() {
                return Ok(false);
            }
            let left = batch.due.saturating_sub(began.elapsed());
            if left.is_zero() {
                break;
            }
            std::thread::sleep(left.min(NAP));
        }
        bytes.clear();
        for entry in &batch.entries {
            encode(entry, format, &mut bytes);
        }
        if !output.send(&bytes)? {
            return Ok(false);
        }
    }
    say(&player.farewell());
    Ok(true)
}

fn say(sentence: &str) {
    // Where nobody can read it, it need not be said.
    let _ = writeln!(io::stderr(), "{sentence}");
}

enum Output {
    Standard(io::Stdout),
    Tcp(Server),
}

impl Output {
    /// Whether anybody wants more.
    fn send(&mut self, bytes: &[u8]) -> Result<bool, Failure> {
        match self {
            Self::Standard(output) => {
                match output.write_all(bytes).and_then(|()| output.flush()) {
                    Ok(()) => Ok(true),
                    // Who read has gone, as `head` does.
                    Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(false),
                    Err(error) => {
                        let sentence = format!("standard output cannot be written to: {error}");
                        Err(Failure::new(Kind::File, sentence))
                    }
                }
            }
            Self::Tcp(server) => {
                server.send(bytes);
                Ok(true)
            }
        }
    }
}
