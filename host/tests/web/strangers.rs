//! Who is not meant is told so, and nobody else suffers from it.

use std::io::{Read, Write};
use std::net::{Ipv6Addr, TcpListener, TcpStream};

use vrduino_host::web::page::PARTS;

use crate::client::{a_while, dial, exchange, get, open};
use crate::program::{command, vrduino};
use crate::server::Server;

/// A port that is not there: nothing is plugged in, whatever is plugged in here.
const NOBODY: [&str; 2] = ["--port", "/dev/no-such-port"];

fn status(port: u16, path: &str, host: &str, origin: Option<&str>) -> u16 {
    match open(port, path, host, origin) {
        Ok(_) => 101,
        Err((status, sentence)) => {
            assert!(sentence.ends_with(".\n"), "{status} says why: {sentence:?}");
            status
        }
    }
}

#[test]
fn the_stream_of_the_page_is_for_the_page() {
    let program = Server::view(&NOBODY);
    let port = program.port;
    let own = |host: &str| format!("http://{host}:{port}");
    for host in ["localhost", "127.0.0.1", "[::1]"] {
        assert_eq!(status(port, "/stream", host, Some(&own(host))), 101);
    }
    assert_eq!(status(port, "/stream", "localhost", None), 101);
    for origin in [
        "null",
        "http://localhost",
        "http://localhost:1",
        "http://[::1]:1",
        "https://evil.example",
        "http://127.0.0.1.evil.example",
        &format!("https://localhost:{port}"),
        &format!("http://localhost.evil.example:{port}"),
        // Another name for the same, but a page of the one is not a page of the other.
        &own("127.0.0.1"),
    ] {
        let found = status(port, "/stream", "localhost", Some(origin));
        assert_eq!(found, 403, "{origin}");
    }
}

#[test]
fn the_lines_are_for_pages_of_this_computer() {
    let program = Server::serve(&NOBODY);
    for origin in [
        None,
        Some("null"),
        Some("http://localhost"),
        Some("http://localhost:3000"),
        Some("https://localhost:3000"),
        Some("http://127.0.0.1:5500"),
        Some("http://[::1]:8000"),
    ] {
        assert_eq!(
            status(program.port, "/", "localhost", origin),
            101,
            "{origin:?}"
        );
    }
    for origin in [
        "http://evil.example",
        "https://evil.example:8081",
        "http://127.0.0.1.evil.example",
        "http://localhost:3000@evil.example",
        "file:///home",
        "",
    ] {
        assert_eq!(
            status(program.port, "/", "localhost", Some(origin)),
            403,
            "{origin}"
        );
    }
}

/// A foreign name that leads here (DNS rebinding) makes its page no page of ours.
#[test]
fn a_foreign_name_leads_nowhere() {
    for program in [Server::view(&NOBODY), Server::serve(&NOBODY)] {
        let port = program.port;
        for path in ["/", "/stream"] {
            let origin = format!("http://evil.example:{port}");
            assert_eq!(status(port, path, "evil.example", Some(&origin)), 403);
            assert_eq!(status(port, path, "evil.example", None), 403);
            let asked = format!("GET {path} HTTP/1.1\r\nHost: evil.example\r\n\r\n");
            let answer = exchange(dial(port), asked.as_bytes()).expect("an answer");
            assert_eq!(answer.status, 403);
            assert!(!answer.body.contains("<html"));
        }
    }
}

#[test]
fn every_part_of_the_page_comes_as_what_it_is() {
    let program = Server::view(&NOBODY);
    for part in PARTS {
        let path = format!("/{}", part.name);
        let answer = get(program.port, &path);
        assert_eq!(answer.status, 200, "{path}");
        assert_eq!(answer.body, part.text);
        assert_eq!(answer.field("content-type"), Some(part.mime()));
        assert_eq!(answer.field("cache-control"), Some("no-store"));
        assert_eq!(answer.field("x-content-type-options"), Some("nosniff"));
        let policy = answer.field("content-security-policy").expect("a policy");
        assert!(policy.starts_with("default-src 'none'; script-src 'self';"));
        assert!(!policy.contains("unsafe"));
        assert_eq!(answer.field("access-control-allow-origin"), None);
    }
    assert_eq!(get(program.port, "/").body, PARTS[0].text);
    assert_eq!(get(program.port, "/?whatever").status, 200);
    let asked = "HEAD / HTTP/1.1\r\nHost: localhost\r\n\r\n";
    let answer = exchange(dial(program.port), asked.as_bytes()).expect("an answer");
    assert_eq!((answer.status, answer.body.as_str()), (200, ""));
    let length = PARTS[0].text.len().to_string();
    assert_eq!(answer.field("content-length"), Some(length.as_str()));
}

/// The page is in the network of version 6 as well, where this computer has one.
#[test]
fn both_loopbacks_serve() {
    let program = Server::view(&NOBODY);
    if TcpListener::bind((Ipv6Addr::LOCALHOST, 0)).is_err() {
        // Then there is nobody to ask for it either.
        return;
    }
    let stream = TcpStream::connect((Ipv6Addr::LOCALHOST, program.port)).expect("it listens");
    let asked = format!("GET / HTTP/1.1\r\nHost: [::1]:{}\r\n\r\n", program.port);
    let answer = exchange(stream, asked.as_bytes()).expect("an answer");
    assert_eq!((answer.status, answer.body.as_str()), (200, PARTS[0].text));
}

#[test]
fn what_is_no_request_is_answered_and_does_no_harm() {
    let long = format!(
        "GET / HTTP/1.1\r\nHost: localhost\r\nX: {}\r\n\r\n",
        "x".repeat(9000)
    );
    let many = format!(
        "GET / HTTP/1.1\r\nHost: localhost\r\n{}\r\n",
        "X: x\r\n".repeat(100)
    );
    let handshake = |fields: &str| {
        format!(
            "GET /stream HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n{fields}\r\n"
        )
    };
    let no_key = handshake("Sec-WebSocket-Version: 13\r\n");
    let bad_key = handshake("Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: short\r\n");
    let old =
        handshake("Sec-WebSocket-Version: 8\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n");
    let table: [(&[u8], u16); 14] = [
        (b"\x16\x03\x01\x00\xa5\x01\x00\x00\xa1\x03\x03", 400),
        (b"\0\0\0\0\r\n\r\n", 400),
        (b"GET / HTTP/2.0\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\n\r\n", 400),
        (
            b"GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n",
            400,
        ),
        (
            b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 3\r\n\r\nabc",
            405,
        ),
        (
            b"GET /..%2f..%2fetc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n",
            404,
        ),
        (b"GET /nothing HTTP/1.1\r\nHost: localhost\r\n\r\n", 404),
        (b"GET /stream HTTP/1.1\r\nHost: localhost\r\n\r\n", 426),
        (no_key.as_bytes(), 400),
        (bad_key.as_bytes(), 400),
        (old.as_bytes(), 400),
        (long.as_bytes(), 431),
        (many.as_bytes(), 431),
    ];
    let program = Server::view(&NOBODY);
    for (bytes, status) in table {
        let answer = exchange(dial(program.port), bytes).expect("an answer");
        let asked = String::from_utf8_lossy(&bytes[..bytes.len().min(60)]);
        assert_eq!(answer.status, status, "{asked}");
        assert!(answer.body.ends_with(".\n"), "{asked}: {}", answer.body);
    }
    assert_eq!(get(program.port, "/").status, 200);
}

#[test]
fn who_asks_slowly_holds_up_nobody() {
    let program = Server::view(&NOBODY);
    let silent: Vec<_> = (0..10).map(|_| dial(program.port)).collect();
    let mut slow = dial(program.port);
    slow.write_all(b"GET / HTTP/1.1\r\nHost: loc")
        .expect("it reads");
    assert_eq!(get(program.port, "/").status, 200);
    let answer = exchange(slow, b"al").expect("an answer");
    assert_eq!(answer.status, 408);
    for mut stream in silent {
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("it ends");
        assert!(answer.is_empty(), "who asks nothing is answered nothing");
    }
}

#[test]
fn too_many_are_told_so_and_room_comes_back() {
    let program = Server::view(&NOBODY);
    // Those that ask nothing are let go after a while; these stay.
    let stream = |_| {
        open(program.port, "/stream", "localhost", None)
            .unwrap_or_else(|answer| panic!("{answer:?}"))
    };
    let mut many: Vec<_> = (0..64).map(stream).collect();
    assert_eq!(get(program.port, "/").status, 503);
    many.truncate(60);
    let again = (0..100).any(|_| {
        a_while();
        get(program.port, "/").status == 200
    });
    assert!(again, "room does not come back");
}

#[test]
fn the_next_port_that_is_free_will_do_unless_one_is_named() {
    let start = || Server::spawn(command().args(["view", "--no-open"]).args(NOBODY));
    let (first, second) = (start(), start());
    assert_ne!(first.port, second.port);
    for program in [first, second] {
        assert!((8080..8100).contains(&program.port), "{}", program.port);
        assert_eq!(get(program.port, "/").status, 200);
    }
}

#[test]
fn a_port_that_is_taken_is_said_to_be() {
    let taken = TcpListener::bind(("127.0.0.1", 0)).expect("a port");
    let port = taken.local_addr().expect("an address").port().to_string();
    vrduino(&["view", "--no-open", "--http-port", &port])
        .expect(6)
        .said(&format!("port {port} of this computer is taken"))
        .said("--http-port");
    vrduino(&["serve", "--ws-port", &port])
        .expect(6)
        .said("node server.js")
        .said("--ws-port");
}
