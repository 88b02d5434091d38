//! A WebSocket that never makes anybody wait: what does not go out now goes out later, and a browser
//! that has not taken all of it for 5 s is given up.

use std::io::{self, Write};
use std::net::TcpStream;
use std::thread;
use std::time::{Duration, Instant};

use tungstenite::handshake::server::{create_response, write_response};
use tungstenite::http::StatusCode;
use tungstenite::http::header::UPGRADE;
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

use super::http::{self, Incoming, Response};
use crate::failure::is_not_yet;

/// Of what a page has to say.
const MESSAGE: usize = 4 * 1024;

/// Of what waits for a page, besides what the system holds.
const WAITING: usize = 1024 * 1024;

/// How long a page may leave something waiting.
pub const PATIENCE: Duration = Duration::from_secs(5);

/// How long a page may take to answer a good-bye, and how often it is looked whether it has.
const FAREWELL: Duration = Duration::from_millis(300);
const LOOK: Duration = Duration::from_millis(10);

/// Why a connection is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// The other end has left, or does not keep to the protocol.
    Left,
    /// The other end takes less than there is, for too long or by too much.
    TooSlow,
}

/// The connection.
#[derive(Debug)]
pub struct Socket {
    socket: WebSocket<TcpStream>,
    /// Since when something has been waiting to go out.
    stuck: Option<Instant>,
}

/// The answer to a request that is to become a WebSocket.
///
/// # Errors
///
/// The answer to one that cannot.
pub fn check(incoming: &Incoming) -> Result<Vec<u8>, Response> {
    let request = &incoming.request;
    let mut bytes = Vec::new();
    let response =
        create_response(request).and_then(|response| write_response(&mut bytes, &response));
    if response.is_ok() {
        return Ok(bytes);
    }
    if request.headers().contains_key(UPGRADE) {
        let sentence = "This is no handshake of a WebSocket (RFC 6455, version 13).";
        return Err(http::text(StatusCode::BAD_REQUEST, sentence));
    }
    let sentence = "Here is a stream, not a page: open it as a WebSocket.";
    Err(Response {
        field: Some(("Upgrade", "websocket")),
        ..http::text(StatusCode::UPGRADE_REQUIRED, sentence)
    })
}

impl Socket {
    /// Sends the answer of [`check`]; from then on it is one.
    ///
    /// # Errors
    ///
    /// The connection breaks.
    pub fn open(mut stream: TcpStream, answer: &[u8], rest: Vec<u8>) -> io::Result<Self> {
        stream.set_write_timeout(Some(http::PATIENCE))?;
        stream.write_all(answer)?;
        stream.set_nodelay(true)?;
        stream.set_nonblocking(true)?;
        let config = WebSocketConfig::default()
            .max_message_size(Some(MESSAGE))
            .max_frame_size(Some(MESSAGE))
            .write_buffer_size(0)
            .max_write_buffer_size(WAITING);
        Ok(Self {
            socket: WebSocket::from_partially_read(stream, rest, Role::Server, Some(config)),
            stuck: None,
        })
    }

    /// Sends, now or as soon as it goes out.
    ///
    /// # Errors
    ///
    /// The connection is over.
    pub fn send(&mut self, message: impl Into<Message>) -> Result<(), Over> {
        let sent = self.socket.send(message.into());
        self.went(sent)
    }

    /// Whether all has gone out; otherwise nothing more should be sent yet.
    ///
    /// # Errors
    ///
    /// The connection is over.
    pub fn is_clear(&mut self) -> Result<bool, Over> {
        if self.stuck.is_some() {
            let flushed = self.socket.flush();
            self.went(flushed)?;
        }
        Ok(self.stuck.is_none())
    }

    fn went(&mut self, result: Result<(), Error>) -> Result<(), Over> {
        match result {
            Ok(()) => self.stuck = None,
            Err(Error::Io(error)) if is_not_yet(&error) => {
                let since = *self.stuck.get_or_insert_with(Instant::now);
                if since.elapsed() > PATIENCE {
                    return Err(Over::TooSlow);
                }
            }
            Err(Error::WriteBufferFull(_)) => return Err(Over::TooSlow),
            Err(_) => return Err(Over::Left),
        }
        Ok(())
    }

    /// What the other end has said, if it has.
    ///
    /// # Errors
    ///
    /// The connection is over.
    pub fn receive(&mut self) -> Result<Option<String>, Over> {
        match self.socket.read() {
            Ok(Message::Text(text)) => Ok(Some(text.as_str().to_owned())),
            // Answered by the library, or said by nobody whom this is for.
            Ok(_) => Ok(None),
            Err(Error::Io(error)) if is_not_yet(&error) => Ok(None),
            Err(_) => Err(Over::Left),
        }
    }

    /// Says good-bye, and why; who does not answer is not waited for long.
    pub fn close(mut self, reason: &'static str) {
        let frame = CloseFrame {
            code: CloseCode::Away,
            reason: reason.into(),
        };
        let until = Instant::now() + FAREWELL;
        let mut going = self.went_or_waits(|socket| socket.close(Some(frame)));
        while going && Instant::now() < until {
            thread::sleep(LOOK);
            going = self.went_or_waits(|socket| socket.read().map(|_| ()));
        }
    }

    fn went_or_waits(
        &mut self,
        act: impl FnOnce(&mut WebSocket<TcpStream>) -> Result<(), Error>,
    ) -> bool {
        match act(&mut self.socket) {
            Ok(()) => true,
            Err(Error::Io(error)) => is_not_yet(&error),
            Err(_) => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::net::{TcpListener, TcpStream};

    use tungstenite::Message;

    use super::{Over, Socket, WAITING};

    #[test]
    fn who_takes_nothing_costs_so_much_and_no_more() {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let _other = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (stream, _) = listener.accept().unwrap();
        let mut socket = Socket::open(stream, b"", Vec::new()).unwrap();
        let batch = vec![0; 64 * 1024];
        // Until the system takes nothing more for it.
        while socket.is_clear().unwrap() {
            socket.send(Message::Binary(batch.clone().into())).unwrap();
        }
        let mut sent = 0;
        let over = loop {
            match socket.send(Message::Binary(batch.clone().into())) {
                Ok(()) => sent += batch.len(),
                Err(over) => break over,
            }
            assert!(sent <= WAITING, "{sent} bytes wait for it");
        };
        assert_eq!(over, Over::TooSlow);
    }
}
