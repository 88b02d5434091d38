//! Listens on loopback, and has every connection dealt with in a thread of its own.

use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::{self, Scope};
use std::time::Duration;

use tungstenite::http::StatusCode;

use super::http;

/// Connections at a time; a page needs one, and six while it is loaded.
const CONNECTIONS: usize = 64;

/// How often a free port is looked for that is free in both kinds of network.
const ATTEMPTS: usize = 16;

/// A port of this computer which no other computer can reach.
#[derive(Debug)]
pub struct Server {
    listeners: Vec<TcpListener>,
    port: u16,
    ending: AtomicBool,
    connections: AtomicUsize,
}

impl Server {
    /// Takes this port of 127.0.0.1 and, where there is such a thing, of ::1; any free one for 0.
    ///
    /// # Errors
    ///
    /// It is taken.
    pub fn bind(port: u16) -> io::Result<Self> {
        let mut taken = None;
        for _ in 0..if port == 0 { ATTEMPTS } else { 1 } {
            let v4 = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
            let port = v4.local_addr()?.port();
            let mut listeners = vec![v4];
            match TcpListener::bind((Ipv6Addr::LOCALHOST, port)) {
                Ok(v6) => listeners.push(v6),
                Err(error) if error.kind() == io::ErrorKind::AddrInUse => {
                    taken = Some(error);
                    continue;
                }
                // A computer without IPv6 is well without.
                Err(_) => {}
            }
            return Ok(Self {
                listeners,
                port,
                ending: AtomicBool::new(false),
                connections: AtomicUsize::new(0),
            });
        }
        Err(taken.unwrap_or_else(|| io::ErrorKind::AddrInUse.into()))
    }

    /// The port.
    pub fn port(&self) -> u16 {
        self.port
    }

    /// Whether those who deal with connections are to come to an end.
    pub fn is_ending(&self) -> bool {
        self.ending.load(Ordering::Relaxed)
    }

    /// Has connections dealt with by `deal` until `meanwhile` returns.
    pub fn run<T>(&self, deal: impl Fn(TcpStream) + Sync, meanwhile: impl FnOnce() -> T) -> T {
        thread::scope(|scope| {
            let deal = &deal;
            for listener in &self.listeners {
                scope.spawn(move || self.accept(listener, scope, deal));
            }
            let _end = End(self);
            meanwhile()
        })
    }

    fn accept<'scope>(
        &'scope self,
        listener: &TcpListener,
        scope: &'scope Scope<'scope, '_>,
        deal: &'scope (impl Fn(TcpStream) + Sync),
    ) {
        loop {
            let accepted = listener.accept();
            if self.is_ending() {
                return;
            }
            let Ok((stream, _)) = accepted else {
                // Out of something; by then some of it may be free again.
                thread::sleep(Duration::from_millis(50));
                continue;
            };
            let before = self.connections.fetch_add(1, Ordering::Relaxed);
            scope.spawn(move || {
                if before < CONNECTIONS {
                    deal(stream);
                } else {
                    let sentence = "Too many pages look at this board: close some of them.";
                    let response = http::text(StatusCode::SERVICE_UNAVAILABLE, sentence);
                    let _ = http::answer(&stream, &response, false);
                }
                self.connections.fetch_sub(1, Ordering::Relaxed);
            });
        }
    }
}

/// Ends the server when it is dropped: whoever waits for a connection gets one.
struct End<'a>(&'a Server);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.ending.store(true, Ordering::Relaxed);
        for address in self.0.listeners.iter().map(TcpListener::local_addr) {
            let connect =
                |address: SocketAddr| TcpStream::connect_timeout(&address, Duration::from_secs(1));
            // One that does not take any connection more has been woken by that of another.
            let _ = address.and_then(connect);
        }
    }
}
