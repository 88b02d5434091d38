//! `cargo emulate`: boots the tracker's image on the emulated board and prints what it streams.

mod arguments;

mod port;

mod report;

mod tools;

use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::cpu::Pace;
use vrduino_emulator::firmware;
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::{self, Motion};
use vrduino_emulator::time::{self, MILLISECOND, Ticks};
use vrduino_emulator::witness::{Stop, Trap};

use arguments::Arguments;
use port::PseudoTerminal;
use report::Report;

type Error = Box<dyn std::error::Error>;

/// Exit code of a run that ended in a trap.
const TRAPPED: u8 = 3;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if arguments.traps {
        for trap in Trap::ALL {
            println!("{trap}\n    {}", trap.rule());
        }
        return ExitCode::SUCCESS;
    }
    match run(&arguments) {
        Ok(None) => ExitCode::SUCCESS,
        Ok(Some(stop)) => {
            eprintln!("\n{stop}");
            ExitCode::from(TRAPPED)
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Runs until the end, the limit, Ctrl-C, or a trap, which it returns.
fn run(arguments: &Arguments) -> Result<Option<Stop>, Error> {
    // What the user has given is looked at first: no point in building before a wrong file name.
    let motion = choose_motion(arguments)?;
    let (description, ends) = (motion.describe(), motion.duration());
    let path = match &arguments.image {
        Some(path) => path.clone(),
        None => firmware::build(firmware::BuildOptions { quiet: true })?,
    };
    let image = Image::open(&path)?;
    let setup = Setup {
        motion,
        who_am_i: arguments.who_am_i,
        sensor_clock_error: arguments.sensor_clock / 100.0,
        allowed: arguments.allowed(),
        pace: if arguments.pessimistic {
            Pace::Greatest
        } else {
            Pace::Least
        },
        skip_polling: true,
        timed_function: arguments.time.clone().unwrap_or_default(),
    };
    let mut board = Board::new(image, setup);
    arguments.tools.watch(&mut board)?;
    let terminal = PseudoTerminal::open()?;
    eprintln!("image   {}", path.display());
    eprintln!("motion  {description}");
    if let Some(path) = terminal.path() {
        eprintln!("port    {path}");
    }
    let limit = arguments.seconds.or(ends).map(time::ticks);
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed))?;

    let mut session = Session {
        terminal,
        report: Report::new(),
        realtime: arguments.realtime,
        paced_since: None,
    };
    let mut script = arguments.script();
    while limit.is_none_or(|limit| board.now() < limit)
        && board.stop().is_none()
        && !interrupted.load(Ordering::Relaxed)
    {
        script.apply(&mut board);
        board.run(MILLISECOND.min(limit.map_or(MILLISECOND, |limit| limit - board.now())));
        match session.pass_on(&mut board) {
            // Whoever read our output has seen enough.
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(None),
            result => result?,
        }
    }
    board
        .finish_watching()
        .map_err(|error| format!("the trace or the VCD file could not be written: {error}"))?;
    session.report.print(&mut board);
    Ok(board.stop().cloned())
}

/// What moves the sensor, from the chosen start.
fn choose_motion(arguments: &Arguments) -> Result<Box<dyn Motion>, Error> {
    let motion = match &arguments.motion {
        Some(path) => motion::open(path)?,
        None => motion::built_in(),
    };
    Ok(motion::skip(motion, arguments.start)?)
}

/// The PC's side: where the stream goes and how fast.
struct Session {
    terminal: PseudoTerminal,
    report: Report,
    realtime: bool,
    /// Wall and emulated time from which on the run is held to real time.
    paced_since: Option<(Instant, Ticks)>,
}

impl Session {
    fn pass_on(&mut self, board: &mut Board) -> io::Result<()> {
        for event in board.take_events() {
            eprintln!("{event}");
        }
        let attached = self.terminal.is_attached();
        let received = {
            let mut chip = board.chip_quietly();
            let keys = self.terminal.read();
            if !keys.is_empty() {
                chip.host.send(&keys);
            }
            if self.terminal.is_full() != self.terminal.was_full {
                // A reader that falls behind holds the host back, and the host the board.
                self.terminal.was_full = self.terminal.is_full();
                chip.host.set_reading(!self.terminal.was_full);
            }
            chip.host.take_received()
        };
        if !received.is_empty() {
            self.report.take_in(board.now(), &received);
            if attached {
                self.terminal.write(&received);
            }
            let mut stdout = io::stdout().lock();
            stdout
                .write_all(&received)
                .and_then(|()| stdout.flush())
                .map_err(|error| {
                    io::Error::new(error.kind(), format!("standard output: {error}"))
                })?;
        }
        self.terminal.flush();
        self.pace(attached || self.realtime, board.now());
        Ok(())
    }

    /// Waits until real time has caught up with emulated time, while somebody watches.
    fn pace(&mut self, wanted: bool, now: Ticks) {
        if !wanted {
            self.paced_since = None;
            return;
        }
        let (wall, emulated) = *self
            .paced_since
            .get_or_insert_with(|| (Instant::now(), now));
        let ahead =
            Duration::from_secs_f64(time::seconds(now - emulated)).saturating_sub(wall.elapsed());
        if ahead.is_zero() {
            // Behind: do not make up for it later by running too fast.
            self.paced_since = Some((Instant::now(), now));
        } else {
            std::thread::sleep(ahead);
        }
    }
}
