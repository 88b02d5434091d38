//! As much of HTTP/1.1 as a page needs: a request's head, an answer, the end of the connection.

use std::borrow::Cow;
use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

use tungstenite::http::{self, Method, StatusCode, Version};

use crate::failure::is_not_yet;

/// A request; a body is neither wanted nor read.
pub type Request = http::Request<()>;

/// An answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Response {
    /// How it went.
    pub status: StatusCode,
    /// Type of the body.
    pub mime: &'static str,
    /// A field that only this answer has, and its value.
    pub field: Option<(&'static str, &'static str)>,
    /// What was asked for, or why it is not to be had.
    pub body: Cow<'static, [u8]>,
}

/// Bytes of a head at most.
pub const HEAD: usize = 8 * 1024;

/// Fields of a head at most.
const FIELDS: usize = 64;

/// How long a head may take, however slowly it comes.
pub const PATIENCE: Duration = Duration::from_secs(5);

/// How often it is looked whether the server ends meanwhile.
const LOOK: Duration = Duration::from_millis(100);

/// What every answer says: the page may load its own parts and nothing else, and be part of no other.
const FIELDS_OF_ALL: &str = "\
    Connection: close\r\n\
    Cache-Control: no-store\r\n\
    Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; \
    connect-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'\r\n\
    Cross-Origin-Resource-Policy: same-origin\r\n\
    Referrer-Policy: no-referrer\r\n\
    X-Content-Type-Options: nosniff\r\n";

/// A request, and what has come behind its head.
#[derive(Debug)]
pub struct Incoming {
    /// The head.
    pub request: Request,
    /// The beginning of what follows.
    pub rest: Vec<u8>,
}

/// Reads a head. None if nothing was asked, or `is_ending` says that nobody will answer.
///
/// # Errors
///
/// What to answer to what is no request.
pub fn read(
    mut stream: &TcpStream,
    is_ending: impl Fn() -> bool,
) -> Result<Option<Incoming>, Response> {
    let until = Instant::now() + PATIENCE;
    let mut head = Vec::new();
    let mut chunk = [0; 1024];
    if stream.set_read_timeout(Some(LOOK)).is_err() {
        return Ok(None);
    }
    loop {
        if let Some((length, request)) = parse(&head)? {
            let rest = head.split_off(length);
            return Ok(Some(Incoming { request, rest }));
        }
        if head.len() >= HEAD {
            return Err(text(
                StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE,
                "The head of the request is too long: 8 KiB are enough for every browser.",
            ));
        }
        if is_ending() {
            return Ok(None);
        }
        if Instant::now() >= until {
            return if head.is_empty() {
                Ok(None)
            } else {
                let sentence = "The request did not come to its end in five seconds: ask again.";
                Err(text(StatusCode::REQUEST_TIMEOUT, sentence))
            };
        }
        let room = chunk.len().min(HEAD - head.len());
        match stream.read(&mut chunk[..room]) {
            Ok(0) => return Ok(None),
            Ok(count) => head.extend_from_slice(&chunk[..count]),
            Err(error) if is_not_yet(&error) => {}
            Err(_) => return Ok(None),
        }
    }
}

/// The head and its length, once all of it is there.
fn parse(bytes: &[u8]) -> Result<Option<(usize, Request)>, Response> {
    let bad = || {
        text(
            StatusCode::BAD_REQUEST,
            "This is no request of HTTP/1.1: open the address in a browser.",
        )
    };
    let mut fields = [httparse::EMPTY_HEADER; FIELDS];
    let mut head = httparse::Request::new(&mut fields);
    let length = match head.parse(bytes) {
        Ok(httparse::Status::Complete(length)) => length,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::TooManyHeaders) => {
            return Err(text(
                StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE,
                "The request has more than 64 fields.",
            ));
        }
        Err(_) => return Err(bad()),
    };
    let (Some(method), Some(path), Some(minor)) = (head.method, head.path, head.version) else {
        return Err(bad());
    };
    let mut request = http::Request::builder()
        .method(method)
        .uri(path)
        .version(if minor == 0 {
            Version::HTTP_10
        } else {
            Version::HTTP_11
        });
    for field in head.headers.iter() {
        request = request.header(field.name, field.value);
    }
    let request = request.body(()).map_err(|_| bad())?;
    Ok(Some((length, request)))
}

/// Refuses what neither GET nor HEAD asks.
///
/// # Errors
///
/// What to answer.
pub fn only_reads(request: &Request) -> Result<(), Response> {
    if matches!(*request.method(), Method::GET | Method::HEAD) {
        return Ok(());
    }
    Err(Response {
        field: Some(("Allow", "GET, HEAD")),
        ..text(
            StatusCode::METHOD_NOT_ALLOWED,
            "Only GET and HEAD are answered here.",
        )
    })
}

/// A sentence as an answer.
pub fn text(status: StatusCode, sentence: &str) -> Response {
    Response {
        status,
        mime: "text/plain; charset=utf-8",
        field: None,
        body: format!("{sentence}\n").into_bytes().into(),
    }
}

/// Answers, and ends the connection.
///
/// # Errors
///
/// The connection breaks.
pub fn answer(mut stream: &TcpStream, response: &Response, head_only: bool) -> io::Result<()> {
    let field = response
        .field
        .map(|(name, value)| format!("{name}: {value}\r\n"));
    let head = format!(
        "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\n{FIELDS_OF_ALL}{}\r\n",
        response.status,
        response.mime,
        response.body.len(),
        field.unwrap_or_default(),
    );
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut bytes = head.into_bytes();
    if !head_only {
        bytes.extend_from_slice(&response.body);
    }
    stream.write_all(&bytes)?;
    stream.shutdown(Shutdown::Write)?;
    // What nobody has read would make the system break the connection, and the answer be lost.
    let until = Instant::now() + LOOK;
    stream.set_read_timeout(Some(LOOK))?;
    let mut rest = [0; 1024];
    while Instant::now() < until && matches!(stream.read(&mut rest), Ok(1..)) {}
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::parse;
    use tungstenite::http::StatusCode;

    #[test]
    fn a_head_in_pieces_is_waited_for() {
        let head = b"GET /main.js?a HTTP/1.1\r\nHost: localhost\r\n\r\n";
        for length in 0..head.len() {
            assert!(parse(&head[..length]).unwrap().is_none());
        }
        let (length, request) = parse(head).unwrap().unwrap();
        assert_eq!(length, head.len());
        assert_eq!(request.uri().path(), "/main.js");
        assert_eq!(request.headers()["host"], "localhost");
    }

    #[test]
    fn garbage_is_a_bad_request() {
        for garbage in [
            b"\x16\x03\x01\x02\x00".as_slice(),
            b"GET\r\n\r\n",
            b"GET / HTTP/9.9\r\n\r\n",
            b"GET /a b HTTP/1.1\r\n\r\n",
            b"GET / HTTP/1.1\r\nno colon\r\n\r\n",
            b"GET http:// HTTP/1.1\r\n\r\n",
        ] {
            let response = parse(garbage).unwrap_err();
            assert_eq!(response.status, StatusCode::BAD_REQUEST, "{garbage:?}");
        }
    }
}
