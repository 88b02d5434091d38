//! `vrduino serve`: the board's lines for the course's pages, as the course's server gives them.

mod frames;

mod keyboard;

mod lines;

mod reader;

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Write};
use std::net::TcpStream;
use std::time::Duration;

use clap::Args;

use crate::arguments::SourceArguments;
use crate::failure::{Failure, Kind};
use crate::hub::{Hold, Hub, State, Subscription, Update};
use crate::interrupt::Interrupt;
use crate::web::server::Server;
use keyboard::{Keyboard, Typed};
use lines::Lines;

/// How long a key is waited for before it is looked what the board says.
const LOOK: Duration = Duration::from_millis(20);

/// Bytes that wait for a board that is not there yet, at most.
const TYPED: usize = 4096;

/// At which the course's pages look.
pub const SERVE_PORT: u16 = 8081;

/// What is asked for.
#[derive(Clone, Debug, Args)]
#[command(after_help = NOTES)]
pub struct Arguments {
    /// Where from.
    #[command(flatten)]
    pub source: SourceArguments,
    /// The port on this computer, 0 for any that is free; the course's pages look at 8081
    #[arg(long, value_name = "N", default_value_t = SERVE_PORT)]
    pub ws_port: u16,
    /// Does not print the board's lines; `d` begins to
    #[arg(long)]
    pub quiet: bool,
}

const NOTES: &str = "\
Start it in the place of `node server.js`; the course's pages run unchanged, as many at once as you like. Only \
programs and pages of this computer are let in: pages from localhost, 127.0.0.1 and [::1] at any port, and those \
opened from a file. What they send is not read.

Keys go to the board at once: 0 to 5 choose what it sends, r recenters, b measures the bias, and a line that begins \
with a colon is a command (:help) and goes with Enter. d stops printing and begins again, Ctrl-C ends. Input from a \
pipe goes to the board too, no faster than it is taken.";

/// Serves the lines until Ctrl-C.
///
/// # Errors
///
/// The port is taken, or nothing more will come.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let interrupt = Interrupt::listen();
    let server =
        Server::bind(arguments.ws_port).map_err(|error| taken(arguments.ws_port, &error))?;
    let hub = Hub::start(arguments.source.choice(), Some("text"));
    // Where nobody reads it, it is served all the same.
    let _ = writeln!(io::stdout(), "ws://localhost:{}", server.port());
    let deal = |stream: TcpStream| reader::deal(stream, &hub, &server);
    server.run(deal, || Desk::new(&hub, !arguments.quiet).run(&interrupt))
}

fn taken(port: u16, error: &io::Error) -> Failure {
    let sentence = match error.kind() {
        ErrorKind::AddrInUse => format!(
            "port {port} of this computer is taken, by the course's server (`node server.js`) or another `vrduino serve` most likely: end that one, or choose another port here with --ws-port and in the page"
        ),
        _ => format!(
            "port {port} of this computer cannot be had: {error}; choose another with --ws-port"
        ),
    };
    Failure::new(Kind::Computer, sentence)
}

/// The terminal: what is typed, and what is printed.
struct Desk<'a> {
    hub: &'a Hub,
    updates: Subscription,
    lines: Lines,
    keyboard: Keyboard,
    /// Typed while no board was there.
    waiting: VecDeque<u8>,
    is_printing: bool,
    said: String,
}

impl<'a> Desk<'a> {
    fn new(hub: &'a Hub, is_printing: bool) -> Self {
        Self {
            hub,
            updates: hub.subscribe(Hold::Newest(reader::HOLD)),
            lines: Lines::from_the_beginning(),
            keyboard: Keyboard::open(),
            waiting: VecDeque::new(),
            is_printing,
            said: String::new(),
        }
    }

    fn run(mut self, interrupt: &Interrupt) -> Result<(), Failure> {
        while !interrupt.has_come() {
            match self.keyboard.next(LOOK) {
                Some(Typed::End) => break,
                Some(Typed::Print) => self.toggle(),
                Some(Typed::Bytes(bytes)) => self.keep(&bytes),
                None => {}
            }
            self.send();
            if let Some(result) = self.listen() {
                return result;
            }
        }
        Ok(())
    }

    fn toggle(&mut self) {
        self.is_printing = !self.is_printing;
        self.say(if self.is_printing {
            "printing what the board sends"
        } else {
            "not printing any more; it is served all the same"
        });
    }

    fn keep(&mut self, bytes: &[u8]) {
        let room = TYPED.saturating_sub(self.waiting.len());
        self.waiting.extend(bytes.iter().take(room));
    }

    fn send(&mut self) {
        if !self.waiting.is_empty() && self.hub.status().state == State::Connected {
            self.hub.press(self.waiting.make_contiguous());
            self.waiting.clear();
        }
    }

    /// Prints what has come; the result if nothing more will.
    fn listen(&mut self) -> Option<Result<(), Failure>> {
        while let Some(update) = self.updates.next(Duration::ZERO) {
            let lines = self.lines.of(&update);
            if self.is_printing && !lines.is_empty() {
                self.print(&lines);
            }
            match update {
                Update::Status(status) => {
                    let sentence = status.sentence();
                    // Why it has ended is the result.
                    let has_failed = status.state == State::Ended && status.trouble.is_some();
                    if sentence != self.said && !has_failed {
                        self.say(&sentence);
                        self.said = sentence;
                    }
                }
                Update::Ended(result) => return Some(result),
                _ => {}
            }
        }
        None
    }

    fn print(&mut self, lines: &[String]) {
        let end = self.keyboard.line_end();
        let text: String = lines.iter().map(|line| format!("{line}{end}")).collect();
        let mut out = io::stdout().lock();
        if out
            .write_all(text.as_bytes())
            .and_then(|()| out.flush())
            .is_err()
        {
            // Nobody reads it any more; it is served all the same.
            self.is_printing = false;
        }
    }

    fn say(&self, sentence: &str) {
        let _ = write!(io::stderr(), "{sentence}{}", self.keyboard.line_end());
    }
}
