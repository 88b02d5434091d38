//! A browser, as far as a server can tell.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use tungstenite::handshake::HandshakeError;
use tungstenite::http::Request;
use tungstenite::{Error, Message, WebSocket};

use crate::program::PATIENCE as LIMIT;

/// What came back.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: String,
}

impl Answer {
    /// The value of a field.
    pub fn field(&self, name: &str) -> Option<&str> {
        self.head.lines().find_map(|line| {
            let (field, value) = line.split_once(": ")?;
            field.eq_ignore_ascii_case(name).then_some(value)
        })
    }
}

pub fn dial(port: u16) -> TcpStream {
    let address = SocketAddr::from(([127, 0, 0, 1], port));
    let stream = TcpStream::connect_timeout(&address, LIMIT).expect("it listens");
    stream.set_read_timeout(Some(LIMIT)).expect("a limit");
    stream.set_write_timeout(Some(LIMIT)).expect("a limit");
    stream
}

/// Sends these bytes and reads to the end; none if the connection is ended without an answer.
pub fn exchange(mut stream: TcpStream, bytes: &[u8]) -> Option<Answer> {
    stream.write_all(bytes).expect("it reads");
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).expect("it ends");
    let answer = String::from_utf8(answer).expect("text");
    let (head, body) = answer.split_once("\r\n\r\n")?;
    let status = head
        .split(' ')
        .nth(1)
        .and_then(|status| status.parse().ok());
    Some(Answer {
        status: status.expect("a status"),
        head: head.to_owned(),
        body: body.to_owned(),
    })
}

/// Asks for this path.
pub fn get(port: u16, path: &str) -> Answer {
    let request = format!("GET {path} HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n");
    exchange(dial(port), request.as_bytes()).expect("an answer")
}

/// An open stream.
pub struct Stream(WebSocket<TcpStream>);

/// Opens the stream of `view`, as its page does.
pub fn view(port: u16) -> Stream {
    let own = format!("http://localhost:{port}");
    open(port, "/stream", "localhost", Some(&own)).expect("let in")
}

/// Opens the lines of `serve`, as a page from elsewhere on this computer does.
pub fn serve(port: u16) -> Stream {
    open(port, "/", "localhost", Some("http://localhost:5500")).expect("let in")
}

/// Opens a stream.
///
/// # Errors
///
/// Status and sentence of the refusal.
pub fn open(
    port: u16,
    path: &str,
    host: &str,
    origin: Option<&str>,
) -> Result<Stream, (u16, String)> {
    let mut request = Request::builder()
        .uri(format!("ws://{host}:{port}{path}"))
        .header("Host", format!("{host}:{port}"))
        .header("Connection", "Upgrade")
        .header("Upgrade", "websocket")
        .header("Sec-WebSocket-Version", "13")
        .header("Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ==");
    if let Some(origin) = origin {
        request = request.header("Origin", origin);
    }
    let request = request.body(()).expect("a request");
    match tungstenite::client(request, dial(port)) {
        Ok((socket, _)) => Ok(Stream(socket)),
        Err(HandshakeError::Failure(Error::Http(response))) => {
            let body = response.body().clone().unwrap_or_default();
            let sentence = String::from_utf8_lossy(&body).into_owned();
            Err((response.status().as_u16(), sentence))
        }
        Err(error) => panic!("no answer to a handshake: {error}"),
    }
}

impl Stream {
    /// The next message; none once it is over.
    pub fn message(&mut self) -> Option<Message> {
        loop {
            match self.0.read() {
                Ok(message) => return Some(message),
                Err(Error::ConnectionClosed) => return None,
                // By a pause of this program.
                Err(Error::Io(error)) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => panic!("the stream breaks: {error}"),
            }
        }
    }

    /// The first of which `find` makes something.
    pub fn find<T>(&mut self, what: &str, mut find: impl FnMut(&Message) -> Option<T>) -> T {
        let began = Instant::now();
        let mut last = String::new();
        while began.elapsed() < LIMIT {
            let message = self.message().expect("the stream goes on");
            if let Some(found) = find(&message) {
                return found;
            }
            if let Message::Text(text) = &message {
                last = text.as_str().to_owned();
            }
        }
        panic!("never comes: {what}; the last text was {last}");
    }

    /// So many lines.
    pub fn lines(&mut self, count: usize) -> Vec<String> {
        (0..count)
            .map(|_| self.find("a line", |message| Some(message.to_text().ok()?.to_owned())))
            .collect()
    }

    /// Sends this text.
    pub fn say(&mut self, text: &str) {
        self.try_say(text).expect("it goes out");
    }

    /// The same to one who may not listen.
    pub fn try_say(&mut self, text: &str) -> Result<(), tungstenite::Error> {
        self.0.send(Message::Text(text.into()))
    }

    /// Whether it ends with a good-bye, whatever comes before.
    pub fn ends_with_good_bye(&mut self) -> bool {
        let mut last = None;
        let began = Instant::now();
        while let Some(message) = self.message() {
            assert!(began.elapsed() < LIMIT, "it does not end");
            last = Some(message);
        }
        matches!(last, Some(Message::Close(Some(frame))) if u16::from(frame.code) == 1001)
    }

    /// Leaves without a word.
    pub fn hang_up(self) {
        let _ = self.0.get_ref().shutdown(std::net::Shutdown::Both);
    }
}

/// Long enough for what is wrong to show itself.
pub fn a_while() {
    std::thread::sleep(Duration::from_millis(300));
}
