//! One TCP connection: bytes in and out without waiting.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};

use super::protocol::{CONGESTED, Operation};
use super::session::Session;
use crate::time::Ticks;

/// How far a connection is.
#[derive(Debug)]
pub(super) enum Stage {
    /// It has not said yet what it wants.
    Opening,
    /// It wants this, and the answer is not known yet.
    Asking(Operation),
    /// The device is being prepared for it.
    Preparing,
    /// It has the device.
    Importing(Session),
    /// It gets the rest of what is to be sent.
    Closing,
}

/// A connection.
#[derive(Debug)]
pub(super) struct Connection {
    stream: TcpStream,
    pub peer: SocketAddr,
    pub stage: Stage,
    /// When it began.
    pub since: Ticks,
    pub received: Vec<u8>,
    pub to_send: Vec<u8>,
    /// The other side has closed it, or it broke.
    ended: bool,
}

impl Connection {
    /// A connection that was just accepted; `None` if it cannot be used without waiting.
    pub fn new(stream: TcpStream, peer: SocketAddr, since: Ticks) -> Option<Connection> {
        stream.set_nonblocking(true).ok()?;
        // Replies are small and each is waited for; a system that cannot do this is only slower.
        let _ = stream.set_nodelay(true);
        Some(Connection {
            stream,
            peer,
            stage: Stage::Opening,
            since,
            received: Vec::new(),
            to_send: Vec::new(),
            ended: false,
        })
    }

    /// Whether the device is its, or about to be.
    pub fn has_device(&self) -> bool {
        let has = matches!(self.stage, Stage::Preparing | Stage::Importing(_));
        has && !self.ended
    }

    /// Whether nothing more can come of it.
    pub fn is_over(&self) -> bool {
        match self.stage {
            Stage::Closing => self.ended || self.to_send.is_empty(),
            // A client may say what it wants and close its half.
            Stage::Asking(_) => false,
            _ => self.ended,
        }
    }

    /// Sends `last`, and then no more.
    pub fn close(&mut self, last: Vec<u8>) {
        self.to_send.extend(last);
        self.stage = Stage::Closing;
    }

    /// Takes what has come.
    pub fn receive(&mut self) {
        let mut chunk = [0; 4096];
        while !self.ended && self.received.len() < CONGESTED {
            match self.stream.read(&mut chunk) {
                Ok(0) => self.ended = true,
                Ok(count) => self.received.extend_from_slice(&chunk[..count]),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => return,
                Err(_) => self.ended = true,
            }
        }
    }

    /// Sends what the other side takes.
    pub fn send(&mut self) {
        while !self.to_send.is_empty() {
            match self.stream.write(&self.to_send) {
                Ok(count) if count > 0 => drop(self.to_send.drain(..count)),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => return,
                _ => {
                    self.ended = true;
                    self.to_send.clear();
                }
            }
        }
    }
}
