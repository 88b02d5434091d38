//! `cargo emulate`: boots the tracker's image on the emulated board and prints what it streams.

mod arguments;

mod eeprom;

mod input;

mod port;

mod record;

mod report;

mod tcp;

mod tools;

mod values;

use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::cpu::Pace;
use vrduino_emulator::firmware;
use vrduino_emulator::gdb;
use vrduino_emulator::host::Host;
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::{self, Motion};
use vrduino_emulator::time::{self, MILLISECOND, Ticks};
use vrduino_emulator::usbip;
use vrduino_emulator::witness::{Stop, Trap};

use arguments::{Arguments, PartKind};
use input::Input;
use port::PseudoTerminal;
use record::{Origin, Recorder, Replay, Stream};
use report::Report;
use tcp::TcpPort;

type Error = Box<dyn std::error::Error>;

/// Says something on standard error; where nobody can read it, it need not be said.
macro_rules! say {
    ($($what:tt)*) => {{
        use std::io::Write;
        let _ = writeln!(std::io::stderr(), $($what)*);
    }};
}
use say;
/// Exit code of a run that ended in a trap.
const TRAPPED: u8 = 3;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if arguments.traps {
        let mut stdout = io::stdout().lock();
        for trap in Trap::ALL {
            // Whoever reads them may have seen enough.
            let _ = writeln!(stdout, "{trap}\n    {}", trap.rule());
        }
        return ExitCode::SUCCESS;
    }
    match run(&arguments) {
        Ok(None) => ExitCode::SUCCESS,
        Ok(Some(stop)) => {
            say!("\n{stop}");
            say!("go on   --allow {} passes it, as silicon would", stop.trap);
            ExitCode::from(TRAPPED)
        }
        Err(error) => {
            say!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Runs until the end, the limit, Ctrl-C, or a trap, which it returns.
fn run(arguments: &Arguments) -> Result<Option<Stop>, Error> {
    // What the user has given is looked at first: no point in building before a wrong file name.
    let motion = choose_motion(arguments)?;
    let (description, ends) = (motion.describe(), motion.duration());
    let kept = arguments.eeprom.as_deref().map(eeprom::read).transpose()?;
    let path = match &arguments.image {
        Some(path) => path.clone(),
        None => firmware::build(firmware::BuildOptions { quiet: true })?,
    };
    let image = Image::open(&path)?;
    let origin = Origin::new(&image, motion.as_ref());
    if let Some(function) = &arguments.time
        && image.address_of(function).is_none()
    {
        return Err(format!(
            "the image has no function, or more than one, whose path ends in {function}; compilers merge small \
             functions into their callers unless they are marked #[inline(never)]"
        )
        .into());
    }
    let setup = Setup {
        motion,
        part: arguments.part(),
        eeprom: kept.unwrap_or_default(),
        allowed: arguments.allowed(),
        pace: if arguments.pessimistic {
            Pace::Greatest
        } else {
            Pace::Least
        },
        skip_polling: true,
        timed_function: arguments.timed().into(),
    };
    let mut board = Board::new(image, setup);
    let tools = &arguments.tools;
    let exporter = arguments.usbip.map(export).transpose()?;
    if exporter.is_some() {
        board.chip().host = Host::exporting();
    }
    let origin = origin.of(&board);
    let replay = tools.replay.as_deref().map(Replay::open).transpose()?;
    if let Some(replay) = &replay {
        replay.check(&origin)?;
    }
    let recorder = tools.record.as_deref();
    let recorder = recorder
        .map(|path| Recorder::create(path, &origin))
        .transpose()?;
    tools.watch(&mut board)?;
    let terminal = PseudoTerminal::open()?;
    say!("image   {}", path.display());
    say!("motion  {description}");
    if let Some(exporter) = &exporter {
        say!("usb/ip  {}, bus ID {}", exporter.address(), usbip::BUS_ID);
    } else if let Some(path) = terminal.path() {
        say!("port    {path}");
    }
    let limit = match &replay {
        Some(replay) => Some(replay.end()),
        None => arguments.seconds.or(ends).map(time::ticks),
    };
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed))?;

    let mut session = Session {
        terminal,
        tcp: tools.tcp_port()?,
        debugger: tools.debugger()?,
        recorder,
        replay,
        was_full: false,
        stream: Stream::default(),
        report: Report::new(),
        realtime: arguments.realtime || exporter.is_some(),
        exporter,
        paced_since: None,
    };
    let mut script = arguments.script();
    let (mut heard, mut measuring) = (true, false);
    while limit.is_none_or(|limit| board.now() < limit)
        && (board.stop().is_none() || session.is_debugged())
        && board.in_loader().is_none()
        && !interrupted.load(Ordering::Relaxed)
        && heard
    {
        tools.measure(&mut board, &mut measuring);
        let inputs = script.due(board.now());
        session.give(&mut board, inputs)?;
        let left = limit.map_or(MILLISECOND, |limit| limit - board.now());
        session.run(&mut board, MILLISECOND.min(left));
        match session.pass_on(&mut board) {
            // Whoever read our output has seen enough.
            Err(error) if is_broken_pipe(&error) => heard = false,
            result => result?,
        }
    }
    if let Some(path) = &arguments.eeprom {
        eeprom::write(path, &board.eeprom())?;
    }
    board
        .finish_watching()
        .map_err(|error| format!("the trace or the VCD file could not be written: {error}"))?;
    if !heard {
        return Ok(None);
    }
    session.report.print(&mut board, arguments.timed());
    session.end(&board, interrupted.load(Ordering::Relaxed))?;
    Ok(board.stop().cloned())
}

fn is_broken_pipe(error: &Error) -> bool {
    error
        .downcast_ref::<io::Error>()
        .is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}

/// What moves the sensor, from the chosen start.
fn choose_motion(arguments: &Arguments) -> Result<Box<dyn Motion>, Error> {
    let motion = match &arguments.motion {
        Some(path) => motion::open(path)?,
        // A part with errors of its own needs none added to what it feels.
        None if arguments.part == PartKind::Perfect => motion::built_in(),
        None => Box::new(motion::Head::new()),
    };
    Ok(motion::skip(motion, arguments.start)?)
}

/// Offers the device on a port, instead of using it.
fn export(port: u16) -> Result<usbip::Server, Error> {
    usbip::Server::open(port).map_err(|error| {
        format!("port {port} of 127.0.0.1 cannot be opened: {error}; give another, or 0 for any free one").into()
    })
}

/// The PC's side: where the stream goes and how fast.
struct Session {
    terminal: PseudoTerminal,
    tcp: Option<TcpPort>,
    debugger: Option<gdb::Server>,
    recorder: Option<Recorder>,
    replay: Option<Replay>,
    /// Whether the host was last told that its reader has fallen behind.
    was_full: bool,
    stream: Stream,
    report: Report,
    realtime: bool,
    /// Who has the device, if it is not used here.
    exporter: Option<usbip::Server>,
    /// Wall and emulated time from which on the run is held to real time.
    paced_since: Option<(Instant, Ticks)>,
}

impl Session {
    fn is_debugged(&self) -> bool {
        self.debugger.as_ref().is_some_and(gdb::Server::holds)
    }

    /// Lets the board run, as far as a debugger allows.
    fn run(&mut self, board: &mut Board, span: Ticks) {
        let Some(debugger) = &mut self.debugger else {
            board.run(span);
            return;
        };
        debugger.run(board, span);
        for note in debugger.take_notes() {
            say!("gdb     {note}");
        }
    }

    /// Gives the board what comes from outside; in a replay, what came then.
    fn give(&mut self, board: &mut Board, inputs: Vec<Input>) -> Result<(), Error> {
        let now = board.now();
        let inputs = match &mut self.replay {
            Some(replay) => replay.due(now),
            None => inputs,
        };
        for input in inputs {
            if let Some(recorder) = &mut self.recorder {
                recorder.note(now, &input)?;
            }
            input.apply(board);
        }
        Ok(())
    }

    /// Hands the stream over, and what was typed to the board.
    fn pass_on(&mut self, board: &mut Board) -> Result<(), Error> {
        for event in board.take_events() {
            say!("{event}");
        }
        if let Some(exporter) = &mut self.exporter {
            exporter.serve(board);
            for note in exporter.take_notes() {
                say!("{:9.4} s  {note}", time::seconds(board.now()));
            }
        }
        let mut attached = self.terminal.is_attached();
        let mut typed = self.terminal.read();
        let mut full = self.terminal.is_full();
        if let Some(tcp) = &mut self.tcp {
            attached |= tcp.is_attached();
            typed.extend(tcp.read());
            full |= tcp.is_full();
        }
        let mut inputs = Vec::new();
        if !typed.is_empty() {
            inputs.push(Input::Typed(typed));
        }
        if full != self.was_full {
            // A reader that falls behind holds the host back, and the host the board.
            self.was_full = full;
            inputs.push(Input::Reading(!full));
        }
        self.give(board, inputs)?;
        let received = board.chip_quietly().host.take_received();
        if !received.is_empty() {
            self.report.take_in(board.now(), &received);
            self.stream.take_in(&received);
            self.terminal.write(&received);
            if let Some(tcp) = &mut self.tcp {
                tcp.write(&received);
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
        if let Some(tcp) = &mut self.tcp {
            tcp.flush();
        }
        self.pace(attached || self.realtime, board.now());
        Ok(())
    }

    /// Writes the end of the run down, or holds it against the recorded one.
    fn end(&mut self, board: &Board, interrupted: bool) -> Result<(), Error> {
        let ending = self.stream.ending(board);
        if let Some(recorder) = &mut self.recorder {
            recorder.end(ending)?;
        }
        if let Some(replay) = self.replay.as_ref().filter(|_| !interrupted) {
            replay.compare(ending)?;
            say!("replay  the same stream and the same state as recorded");
        }
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
