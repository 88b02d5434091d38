//! The stream for any number of programs, by TCP.

use std::io::{self, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::mpsc::{self, SyncSender};
use std::thread::{self, JoinHandle};

use crate::failure::{Failure, Kind};

/// Batches that wait for one who is slow; then it is left alone.
const WAITING: usize = 10_000;

/// A port, and those who read it.
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    clients: Vec<Client>,
}

struct Client {
    send: SyncSender<Arc<[u8]>>,
    thread: JoinHandle<()>,
}

impl Server {
    /// On this computer only; 0 is any free port.
    pub fn open(port: u16) -> Result<Self, Failure> {
        let open = || {
            let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
            listener.set_nonblocking(true)?;
            let address = listener.local_addr()?;
            Ok((listener, address))
        };
        let (listener, address) = open().map_err(|error: io::Error| {
            let sentence = format!(
                "port {port} cannot be had: {error}; choose another, or 0 for any that is free"
            );
            Failure::new(Kind::Computer, sentence)
        })?;
        Ok(Self {
            listener,
            address,
            clients: Vec::new(),
        })
    }

    /// Where it is.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Whether anybody reads.
    pub fn has_clients(&mut self) -> bool {
        self.welcome();
        !self.clients.is_empty()
    }

    /// To everybody who is there.
    pub fn send(&mut self, bytes: &[u8]) {
        self.welcome();
        if bytes.is_empty() {
            return;
        }
        let bytes: Arc<[u8]> = bytes.into();
        // Who has gone, or does not read, is not missed.
        self.clients
            .retain(|client| client.send.try_send(Arc::clone(&bytes)).is_ok());
    }

    fn welcome(&mut self) {
        while let Ok((stream, _)) = self.listener.accept() {
            // Who has gone again is not there.
            if let Ok(client) = Client::start(stream) {
                self.clients.push(client);
            }
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // What was sent arrives.
        for Client { send, thread } in self.clients.drain(..) {
            drop(send);
            let _ = thread.join();
        }
    }
}

impl Client {
    fn start(mut stream: TcpStream) -> io::Result<Self> {
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(std::time::Duration::from_secs(1)))?;
        let mut heard = stream.try_clone()?;
        // A recording heeds nothing; but what lies unread would cut the connection off at its end.
        thread::spawn(move || io::copy(&mut heard, &mut io::sink()));
        let (send, receive) = mpsc::sync_channel::<Arc<[u8]>>(WAITING);
        let thread = thread::spawn(move || {
            for bytes in receive {
                if stream.write_all(&bytes).is_err() {
                    break;
                }
            }
            let _ = stream.shutdown(std::net::Shutdown::Write);
        });
        Ok(Self { send, thread })
    }
}
