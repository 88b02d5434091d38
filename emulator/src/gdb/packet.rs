//! Packets: `$`, text, `#`, a checksum of two hexadecimal digits; answered with `+` or `-`.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// The longest packet that is taken or sent.
pub(super) const LONGEST: usize = 4096;

/// What came from the debugger.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Word {
    /// A packet with the right checksum.
    Packet(Vec<u8>),
    /// Ctrl-C.
    Interrupt,
}

/// The other end.
#[derive(Debug)]
pub(super) struct Connection {
    stream: TcpStream,
    received: Vec<u8>,
    /// Packets are acknowledged, until both agree that TCP loses none.
    acknowledging: bool,
}

impl Connection {
    /// Waits no longer than `patience` for each word.
    pub fn new(stream: TcpStream, patience: Duration) -> io::Result<Connection> {
        stream.set_nonblocking(false)?;
        stream.set_read_timeout(Some(patience))?;
        stream.set_write_timeout(Some(Duration::from_secs(5)))?;
        stream.set_nodelay(true)?;
        Ok(Connection {
            stream,
            received: Vec::new(),
            acknowledging: true,
        })
    }

    /// Sends packets, and expects them, without acknowledgement.
    pub fn stop_acknowledging(&mut self) {
        self.acknowledging = false;
    }

    /// The next word, if there is one; `wait` says whether to have patience.
    ///
    /// # Errors
    ///
    /// The debugger has gone, or sends what is longer than any packet.
    pub fn word(&mut self, wait: bool) -> io::Result<Option<Word>> {
        if let Some(word) = self.parse()? {
            return Ok(Some(word));
        }
        self.stream.set_nonblocking(!wait)?;
        let mut buffer = [0; LONGEST];
        let read = self.stream.read(&mut buffer);
        self.stream.set_nonblocking(false)?;
        match read {
            Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(count) => {
                self.received.extend_from_slice(&buffer[..count]);
                self.parse()
            }
            Err(error) => match error.kind() {
                io::ErrorKind::WouldBlock
                | io::ErrorKind::TimedOut
                | io::ErrorKind::Interrupted => Ok(None),
                _ => Err(error),
            },
        }
    }

    /// The first word of what was received.
    fn parse(&mut self) -> io::Result<Option<Word>> {
        loop {
            let start = self
                .received
                .iter()
                .position(|byte| [b'$', 0x03].contains(byte));
            let Some(start) = start else {
                self.received.clear();
                return Ok(None);
            };
            self.received.drain(..start);
            if self.received[0] == 0x03 {
                self.received.remove(0);
                return Ok(Some(Word::Interrupt));
            }
            let end = self.received.iter().position(|&byte| byte == b'#');
            let Some(end) = end.filter(|end| end + 2 < self.received.len()) else {
                return if self.received.len() > LONGEST + 4 {
                    Err(io::Error::new(
                        io::ErrorKind::InvalidData,
                        "a packet without an end",
                    ))
                } else {
                    Ok(None)
                };
            };
            let packet: Vec<u8> = self.received.drain(..end + 3).collect();
            let text = &packet[1..end];
            let said = std::str::from_utf8(&packet[end + 1..])
                .ok()
                .and_then(|digits| u8::from_str_radix(digits, 16).ok());
            let good = said == Some(checksum(text));
            if self.acknowledging {
                self.stream.write_all(if good { b"+" } else { b"-" })?;
            }
            if good {
                return Ok(Some(Word::Packet(unescape(text))));
            }
        }
    }

    /// Sends a packet; text must have been escaped.
    pub fn send(&mut self, text: &str) -> io::Result<()> {
        let packet = format!("${text}#{:02x}", checksum(text.as_bytes()));
        self.stream.write_all(packet.as_bytes())
    }
}

fn checksum(text: &[u8]) -> u8 {
    text.iter().fold(0, |sum: u8, &byte| sum.wrapping_add(byte))
}

/// `}` stands before a character that was changed by 0x20.
fn unescape(text: &[u8]) -> Vec<u8> {
    let mut bytes = text.iter();
    let mut plain = Vec::with_capacity(text.len());
    while let Some(&byte) = bytes.next() {
        if byte != b'}' {
            plain.push(byte);
        } else if let Some(&escaped) = bytes.next() {
            plain.push(escaped ^ 0x20);
        }
    }
    plain
}
