//! `vrduino view`: the page in the browser, and what it is told.

mod browser;

mod messages;

mod viewer;

use std::io::{self, ErrorKind, Write};
use std::net::TcpStream;
use std::time::Duration;

use clap::Args;
use tungstenite::http::{Method, StatusCode};

use crate::arguments::SourceArguments;
use crate::commands::serve::SERVE_PORT;
use crate::failure::{Failure, Kind};
use crate::hub::{Hub, Status};
use crate::interrupt::Interrupt;
use crate::recording::Reader;
use crate::source::Choice;
use crate::web::http::{self, Incoming, Response};
use crate::web::origin::{self, Origin};
use crate::web::page;
use crate::web::server::Server;
use crate::web::websocket::{self, Socket};
use viewer::Viewer;

/// Port of the page, if it is free.
const HTTP_PORT: u16 = 8080;

/// So many ports are tried from there on.
const HTTP_PORTS: u16 = 20;

/// How often it is looked whether it is to end.
const LOOK: Duration = Duration::from_millis(50);

/// What is asked for.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Where from.
    #[command(flatten)]
    pub source: SourceArguments,
    /// Prints the page's address and leaves it to you to open it
    #[arg(long)]
    pub no_open: bool,
    /// The page's port on this computer, 0 for any that is free [default: 8080, or the next that is free]
    #[arg(long, value_name = "N")]
    pub http_port: Option<u16>,
}

const EXAMPLES: &str = "\
Examples:
  vrduino view              the board that is plugged in, or will be
  vrduino view --emulate    the emulated board
  ssh -L 8080:localhost:8080 lab vrduino view --no-open
                            the board of another computer, at http://localhost:8080/ of this one

The page can be opened as often as you like, on this computer only. Ctrl-C ends the program.";

/// Serves the page until Ctrl-C.
///
/// # Errors
///
/// There is no port for it.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let interrupt = Interrupt::listen();
    let choice = arguments.source.choice();
    if let Choice::Replay(replay) = &choice {
        // What cannot be played need not be served.
        Reader::open(&replay.path)?;
    }
    let server = bind(arguments.http_port)?;
    let site = Site {
        hub: Hub::start(choice.clone(), Some("binary")),
        choice,
    };
    let url = format!("http://127.0.0.1:{}/", server.port());
    // Where nobody reads it, it is in the browser all the same.
    let _ = writeln!(io::stdout(), "{url}");
    if !arguments.no_open {
        browser::open(&url);
    }
    let deal = |stream: TcpStream| site.deal(stream, &server);
    server.run(deal, || {
        let mut said = String::new();
        while !interrupt.has_come() {
            said = tell(said, &site.hub.status());
            std::thread::sleep(LOOK);
        }
    });
    Ok(())
}

/// Says how things are, once for every change.
fn tell(said: String, status: &Status) -> String {
    let sentence = status.sentence();
    if sentence != said {
        let _ = writeln!(io::stderr(), "{sentence}");
    }
    sentence
}

fn bind(port: Option<u16>) -> Result<Server, Failure> {
    let tried = match port {
        Some(port) => port..=port,
        None => HTTP_PORT..=HTTP_PORT + HTTP_PORTS - 1,
    };
    let name = match port {
        Some(port) => format!("port {port} of this computer"),
        None => format!(
            "none of the ports {HTTP_PORT} to {} of this computer",
            HTTP_PORT + HTTP_PORTS - 1
        ),
    };
    let mut error = io::Error::from(ErrorKind::AddrInUse);
    // That of `serve` is left to it, unless it is asked for.
    for port in tried.filter(|&next| port.is_some() || next != SERVE_PORT) {
        match Server::bind(port) {
            Ok(server) => return Ok(server),
            Err(why) => error = why,
        }
    }
    let sentence = match error.kind() {
        ErrorKind::AddrInUse => {
            format!(
                "{name} is taken by another program: choose another with --http-port, or 0 for any that is free"
            )
        }
        _ => format!(
            "{name} cannot be had: {error}; choose another with --http-port, or 0 for any that is free"
        ),
    };
    Err(Failure::new(Kind::Computer, sentence))
}

/// What is served.
struct Site {
    hub: Hub,
    /// What was asked for when the program was started.
    choice: Choice,
}

impl Site {
    fn deal(&self, stream: TcpStream, server: &Server) {
        let incoming = match http::read(&stream, || server.is_ending()) {
            Ok(Some(incoming)) => incoming,
            Ok(None) => return,
            Err(refusal) => return finish(&stream, &refusal, false),
        };
        let head_only = incoming.request.method() == Method::HEAD;
        match find(&incoming) {
            Ok(Found::Answer(response)) => finish(&stream, &response, head_only),
            Ok(Found::Stream(answer)) => {
                if let Ok(socket) = Socket::open(stream, &answer, incoming.rest) {
                    Viewer::new(&self.hub, &self.choice, socket).run(server);
                }
            }
            Err(refusal) => finish(&stream, &refusal, head_only),
        }
    }
}

fn finish(stream: &TcpStream, response: &Response, head_only: bool) {
    // A browser that has left misses nothing.
    let _ = http::answer(stream, response, head_only);
}

enum Found {
    Answer(Response),
    Stream(Vec<u8>),
}

fn find(incoming: &Incoming) -> Result<Found, Response> {
    let request = &incoming.request;
    origin::check_host(request)?;
    http::only_reads(request)?;
    let path = request.uri().path();
    if path == "/stream" {
        if !matches!(origin::of(request), Origin::Own | Origin::Program) {
            return Err(origin::forbidden(
                "The stream is for the page of this server only, not for pages of other sites.",
            ));
        }
        return Ok(Found::Stream(websocket::check(incoming)?));
    }
    let part = page::find(path).ok_or_else(|| {
        let sentence = "There is nothing here: the page is at /.";
        http::text(StatusCode::NOT_FOUND, sentence)
    })?;
    Ok(Found::Answer(Response {
        status: StatusCode::OK,
        mime: part.mime(),
        field: None,
        body: part.text.as_bytes().into(),
    }))
}
