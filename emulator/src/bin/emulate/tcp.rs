//! The serial port for other programs on a TCP port of this computer, where there is no pseudo-terminal or none is
//! wanted.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::time::Duration;

/// Bytes that may wait for a reader before the host stops reading the board.
const WAITING: usize = 4096;

/// How long a reader may take for the last bytes of a run.
const LAST_WORDS: Duration = Duration::from_secs(1);

/// The port, with one client at a time; others wait until it has gone.
#[derive(Debug)]
pub struct TcpPort {
    listener: TcpListener,
    client: Option<TcpStream>,
    waiting: VecDeque<u8>,
}

impl TcpPort {
    /// Listens on `port` of 127.0.0.1; 0 takes any free one.
    pub fn open(port: u16) -> io::Result<TcpPort> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        Ok(TcpPort {
            listener,
            client: None,
            waiting: VecDeque::new(),
        })
    }

    /// Where clients find it.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// Whether a client is there; one that waits is let in.
    pub fn is_attached(&mut self) -> bool {
        if self.client.is_none()
            && let Ok((client, _)) = self.listener.accept()
            && client.set_nonblocking(true).is_ok()
        {
            // A line is wanted when it is there, not when a packet is full.
            let _ = client.set_nodelay(true);
            self.client = Some(client);
        }
        self.client.is_some()
    }

    /// Whether the client has fallen behind.
    pub fn is_full(&self) -> bool {
        self.waiting.len() >= WAITING
    }

    /// Takes what was typed.
    pub fn read(&mut self) -> Vec<u8> {
        let mut buffer = [0; 256];
        match self.client.as_mut().map(|client| client.read(&mut buffer)) {
            Some(Ok(count)) if count > 0 => return buffer[..count].to_vec(),
            Some(Err(error)) if is_patient(&error) => {}
            None => {}
            _ => self.dismiss(),
        }
        Vec::new()
    }

    /// Queues part of the stream.
    pub fn write(&mut self, bytes: &[u8]) {
        if self.client.is_some() {
            self.waiting.extend(bytes);
        }
    }

    /// Hands over as much as the client takes.
    pub fn flush(&mut self) {
        while let (Some(client), false) = (&mut self.client, self.waiting.is_empty()) {
            let (front, _) = self.waiting.as_slices();
            match client.write(front) {
                Ok(count) if count > 0 => drop(self.waiting.drain(..count)),
                Err(error) if is_patient(&error) => return,
                _ => self.dismiss(),
            }
        }
    }

    fn dismiss(&mut self) {
        self.client = None;
        self.waiting.clear();
    }
}

fn is_patient(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
    )
}

/// The end of the run: what waits is handed over, unless the client does not take it.
impl Drop for TcpPort {
    fn drop(&mut self) {
        let Some(client) = &mut self.client else {
            return;
        };
        let rest = self.waiting.make_contiguous();
        let patient = client
            .set_nonblocking(false)
            .and_then(|()| client.set_write_timeout(Some(LAST_WORDS)));
        if patient.is_ok() && client.write_all(rest).is_ok() {
            let _ = client.shutdown(std::net::Shutdown::Write);
        }
    }
}
