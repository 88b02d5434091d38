//! One page or program that reads the lines.

use std::io::{self, Write};
use std::net::TcpStream;
use std::thread;
use std::time::Duration;

use tungstenite::Message;
use tungstenite::http::{Method, StatusCode};

use super::lines::Lines;
use crate::hub::{Hold, Hub, Subscription};
use crate::web::http::{self, Incoming, Response};
use crate::web::origin::{self, Origin};
use crate::web::server::Server;
use crate::web::websocket::{self, Over, Socket};

/// Updates that wait for a slow reader: more than come before it is let go.
pub const HOLD: usize = 20_000;

/// How long the next line is waited for before it is looked whether the reader has left.
const LOOK: Duration = Duration::from_millis(20);

/// Between two attempts with a reader that takes nothing at the moment.
const AGAIN: Duration = Duration::from_millis(5);

/// Deals with one connection.
pub fn deal(stream: TcpStream, hub: &Hub, server: &Server) {
    let incoming = match http::read(&stream, || server.is_ending()) {
        Ok(Some(incoming)) => incoming,
        Ok(None) => return,
        Err(refusal) => return refuse(&stream, &refusal, false),
    };
    let answer = match check(&incoming) {
        Ok(answer) => answer,
        Err(refusal) => {
            let head_only = incoming.request.method() == Method::HEAD;
            return refuse(&stream, &refusal, head_only);
        }
    };
    if let Ok(socket) = Socket::open(stream, &answer, incoming.rest) {
        Reader::new(hub, socket).run(server);
    }
}

fn refuse(stream: &TcpStream, refusal: &Response, head_only: bool) {
    // Who has left misses nothing.
    let _ = http::answer(stream, refusal, head_only);
}

fn check(incoming: &Incoming) -> Result<Vec<u8>, Response> {
    let request = &incoming.request;
    origin::check_host(request)?;
    http::only_reads(request)?;
    if origin::of(request) == Origin::Foreign {
        let sentence = "The board's lines are for pages of this computer only: from localhost, 127.0.0.1, [::1], or a file.";
        return Err(http::text(StatusCode::FORBIDDEN, sentence));
    }
    websocket::check(incoming)
}

/// A reader.
struct Reader {
    socket: Socket,
    updates: Subscription,
    lines: Lines,
}

impl Reader {
    fn new(hub: &Hub, socket: Socket) -> Self {
        Self {
            socket,
            updates: hub.subscribe(Hold::Newest(HOLD)),
            lines: Lines::from_anywhere(),
        }
    }

    /// Until the reader leaves, has not taken all for 5 s, or the server ends.
    fn run(mut self, server: &Server) {
        while !server.is_ending() {
            match self.turn(LOOK) {
                Ok(()) => {}
                Err(Over::Left) => return,
                Err(Over::TooSlow) => {
                    let sentence = "a reader has not taken all for five seconds and is let go";
                    // The terminal may be one that does not return the carriage by itself.
                    let _ = write!(io::stderr(), "{sentence}\r\n");
                    return;
                }
            }
        }
        // What came last is not lost.
        if self.turn(Duration::ZERO).is_ok() {
            self.socket.close("vrduino serve has ended");
        }
    }

    fn turn(&mut self, patience: Duration) -> Result<(), Over> {
        // The course's server does not read what its pages send either.
        self.socket.receive()?;
        if !self.socket.is_clear()? {
            thread::sleep(AGAIN);
            return Ok(());
        }
        let mut next = self.updates.next(patience);
        while let Some(update) = next {
            for line in self.lines.of(&update) {
                self.socket.send(Message::Text(line.into()))?;
            }
            if !self.socket.is_clear()? {
                break;
            }
            next = self.updates.next(Duration::ZERO);
        }
        Ok(())
    }
}
