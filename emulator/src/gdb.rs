//! A debugger's view of the board: the GDB remote serial protocol on a TCP port of this computer.
//!
//! Written here rather than taken from a library, since no library describes an M-profile processor, and since a trap
//! has to say why it stopped the program: protocol as in *Debugging with GDB*, appendix E.
//!
//! Looking has no side effects: registers of peripherals are read from a copy of the chip. Flash cannot be written;
//! breakpoints need no writing.

mod description;

mod packet;

mod session;

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::time::Duration;

use crate::board::Board;
use crate::time::Ticks;
use packet::Connection;
use session::Session;

/// How long to wait for the debugger's next word before others get their turn.
const PATIENCE: Duration = Duration::from_millis(5);

/// Listens for a debugger.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    session: Option<Session>,
    notes: Vec<String>,
    /// Nobody has been here yet: the board waits with its first instruction.
    waiting: bool,
}

impl Server {
    /// Listens on `port` of 127.0.0.1; 0 takes any free one.
    ///
    /// # Errors
    ///
    /// If the port is taken, or may not be used.
    pub fn open(port: u16) -> io::Result<Server> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        Ok(Server {
            listener,
            session: None,
            notes: Vec::new(),
            waiting: true,
        })
    }

    /// Where a debugger finds it.
    ///
    /// # Errors
    ///
    /// If the system does not know it any more.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// What is worth telling since the last call: who came, who went.
    pub fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    /// Whether the board has to wait for the debugger instead of ending, though it has stopped.
    pub fn holds(&self) -> bool {
        self.waiting || self.session.is_some()
    }

    /// Serves the debugger, and runs the board for `span` unless the debugger holds it.
    pub fn run(&mut self, board: &mut Board, span: Ticks) {
        if self.session.is_none() {
            match self.listener.accept() {
                Ok((stream, address)) => self.welcome(board, stream, address),
                Err(_) if self.waiting => {
                    std::thread::sleep(PATIENCE);
                    return;
                }
                Err(_) => {
                    board.run(span);
                    return;
                }
            }
        }
        let Some(session) = &mut self.session else {
            return;
        };
        if session.serve(board, span).is_err() || session.has_ended() {
            self.session = None;
            self.notes
                .push("the debugger has gone; the board runs on".into());
        }
    }

    fn welcome(&mut self, board: &mut Board, stream: TcpStream, address: SocketAddr) {
        match Connection::new(stream, PATIENCE) {
            Ok(connection) => {
                board.do_not_skip();
                if board.instructions() == 0 {
                    // The processor leaves reset, so that there is a place to show.
                    board.step_instruction(1);
                }
                self.waiting = false;
                self.session = Some(Session::new(connection));
                self.notes.push(format!("a debugger at {address}"));
            }
            Err(error) => self.notes.push(format!("no debugger: {error}")),
        }
    }
}

/// The end of the run: the debugger hears that the program has ended.
impl Drop for Server {
    fn drop(&mut self) {
        if let Some(session) = &mut self.session {
            session.end();
        }
    }
}
