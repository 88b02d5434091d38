//! The loopback port: who may have the device, and since when.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};

use super::connection::{Connection, Stage};
use super::protocol::{self, Malformed, Operation, Status};
use super::session::Session;
use crate::board::Board;
use crate::host::{Handover, Host};
use crate::time::{SECOND, Ticks};

/// The device's name on the wire: the first port of the first bus.
pub const BUS_ID: &str = "1-1";

/// Connections at once: one has the device, others may ask what there is.
const CONNECTIONS: usize = 8;
/// How long a connection may take to say what it wants, and how long it waits for a device, in emulated time.
const PATIENCE: Ticks = 10 * SECOND;

/// The port.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    connections: Vec<Connection>,
    notes: Vec<String>,
}

impl Server {
    /// Listens on `port` of the loopback interface; 0 is any free one.
    ///
    /// # Errors
    ///
    /// Whatever the system has against it, such as a port in use.
    pub fn open(port: u16) -> io::Result<Server> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        Ok(Server {
            address: listener.local_addr()?,
            listener,
            connections: Vec::new(),
            notes: Vec::new(),
        })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Takes what is worth telling a person: who comes and goes, and what was wrong with what they sent.
    pub fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    /// Moves bytes between the network and the board's host ([`Host::exporting`]), without waiting for either. To be
    /// called every millisecond of emulated time or so.
    pub fn serve(&mut self, board: &mut Board) {
        let now = board.now();
        while let Ok((stream, peer)) = self.listener.accept() {
            // A connection too many is closed by dropping it.
            if self.connections.len() < CONNECTIONS {
                self.connections.extend(Connection::new(stream, peer, now));
            }
        }
        if self.connections.is_empty() {
            return;
        }
        let mut chip = board.chip();
        let host = &mut chip.host;
        for at in 0..self.connections.len() {
            self.serve_one(at, now, host);
        }
        self.connections.retain(|connection| !connection.is_over());
    }

    fn serve_one(&mut self, at: usize, now: Ticks, host: &mut Host) {
        let taken = self.connections.iter().any(Connection::has_device);
        let connection = &mut self.connections[at];
        let had_device = connection.has_device();
        connection.receive();
        let note = match go_on(connection, now, taken, host) {
            Ok(note) => note,
            Err(Malformed(why)) => {
                connection.close(Vec::new());
                Some(format!("speaks no USB/IP: {why}; the connection is closed"))
            }
        };
        connection.send();
        let note = note.or_else(|| {
            (had_device && connection.is_over()).then(|| "has detached the device".to_owned())
        });
        if had_device && !connection.has_device() {
            host.take_back();
        }
        if let Some(note) = note {
            self.notes.push(format!("{} {note}", connection.peer));
        }
    }
}

/// Takes a connection as far as it will go now; returns what is worth telling.
fn go_on(
    connection: &mut Connection,
    now: Ticks,
    taken: bool,
    host: &mut Host,
) -> Result<Option<String>, Malformed> {
    let late = now >= connection.since + PATIENCE;
    match &mut connection.stage {
        Stage::Opening => match protocol::take_operation(&mut connection.received)? {
            Some(operation) => {
                connection.stage = Stage::Asking(operation);
                return go_on(connection, now, taken, host);
            }
            None if late => return Err(Malformed("it has not said what it wants".to_owned())),
            None => {}
        },
        Stage::Asking(Operation::List) => {
            if late || host.profile().is_some() {
                connection.close(protocol::device_list(BUS_ID, host.profile()));
            }
        }
        Stage::Asking(Operation::Import(name)) => {
            let refusal = if name != BUS_ID {
                Some((Status::NoDevice, "asks for a device that is not there"))
            } else if taken {
                Some((Status::Busy, "asks for the device, which another has"))
            } else if late {
                Some((
                    Status::NotAvailable,
                    "asks for the device, which is not there",
                ))
            } else {
                None
            };
            if let Some((status, note)) = refusal {
                connection.close(protocol::refused(status));
                return Ok(Some(note.to_owned()));
            }
            if host.hand_over() {
                connection.stage = Stage::Preparing;
            }
        }
        Stage::Preparing => match (host.handover(), host.profile()) {
            (Handover::Preparing, _) => {}
            (Handover::Taken, Some(profile)) => {
                connection
                    .to_send
                    .extend(protocol::imported(BUS_ID, profile));
                connection.stage = Stage::Importing(Session::default());
                return Ok(Some("has attached the device".to_owned()));
            }
            _ => {
                connection.close(protocol::refused(Status::NotAvailable));
                return Ok(Some(
                    "asks for the device, which takes no address".to_owned(),
                ));
            }
        },
        Stage::Importing(session) => {
            if host.handover() != Handover::Taken {
                connection.close(Vec::new());
                return Ok(Some("has lost the device: it left the bus".to_owned()));
            }
            session.go_on(&mut connection.received, &mut connection.to_send, host)?;
        }
        Stage::Closing => {}
    }
    Ok(None)
}
