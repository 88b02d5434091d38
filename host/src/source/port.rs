//! A serial port: found, opened, read and written, lost and found again.

mod search;

mod trouble;

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use super::{Event, Gone, Listener, Order};
use crate::failure::{Failure, Kind, is_not_yet};
pub use search::{Found, MANUFACTURER, boards, find, ports};
pub use trouble::{Cause, UDEV_RULE};

/// Bytes that are waited for at a time: a sample is to be passed on when it is there.
const PATIENCE: Duration = Duration::from_millis(4);

/// How often a port that is not there is looked for.
const LOOK_AGAIN: Duration = Duration::from_millis(300);

/// How long a board may take for what is sent to it.
const SENDING: Duration = Duration::from_secs(1);

/// Any speed: USB has its own.
const BAUD: u32 = 115_200;

/// What stands for the name of a port behind which there is a network.
const TCP: &str = "tcp:";

/// Looks for the port, reads it, and looks for it again when it goes.
pub(super) fn run(name: Option<&str>, listener: &mut Listener) -> Result<(), Gone> {
    let began = Instant::now();
    let mut said = None;
    loop {
        match open(name) {
            Ok((mut link, found)) => {
                said = None;
                listener.tell(Event::Connected(found.clone()))?;
                let error = read(link.as_mut(), listener, began)?;
                listener.tell(Event::Lost(trouble::lost(&found, &error)))?;
            }
            Err(failure) => {
                // Once for every reason.
                if said.as_ref() != Some(&failure) {
                    listener.tell(Event::Waiting(failure.clone()))?;
                    said = Some(failure);
                }
            }
        }
        listener.wait(LOOK_AGAIN)?;
    }
}

/// Reads until the port fails: why.
fn read(link: &mut dyn Link, listener: &mut Listener, began: Instant) -> Result<io::Error, Gone> {
    let mut buffer = [0; 4096];
    loop {
        loop {
            match listener.order() {
                Ok(Some(Order::Send(bytes))) => {
                    if let Err(error) = send(link, &bytes) {
                        return Ok(error);
                    }
                }
                Ok(Some(Order::Motion(_) | Order::Turn(_) | Order::Plug(_))) => {}
                Ok(None) => break,
                Err(gone) => return Err(gone),
            }
        }
        match link.read(&mut buffer) {
            Ok(0) => return Ok(io::ErrorKind::UnexpectedEof.into()),
            Ok(count) => {
                let at = began.elapsed().as_secs_f64();
                let bytes = buffer[..count].to_vec();
                listener.tell(Event::Bytes { at, bytes })?;
            }
            Err(error) if is_not_yet(&error) => {}
            Err(error) => return Ok(error),
        }
    }
}

/// Sends all of it, within a second.
fn send(link: &mut dyn Link, mut bytes: &[u8]) -> io::Result<()> {
    let until = Instant::now() + SENDING;
    while !bytes.is_empty() {
        match link.write(bytes) {
            Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
            Ok(count) => bytes = &bytes[count..],
            Err(error) if is_not_yet(&error) && Instant::now() < until => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// What can be read and written with a time limit.
trait Link: Read + Write {}

impl<T: Read + Write + ?Sized> Link for T {}

/// Opens the port, or the one board there is: the link and its name.
fn open(name: Option<&str>) -> Result<(Box<dyn Link>, String), Failure> {
    let name = match name {
        Some(name) => name.to_owned(),
        None => find()?.name,
    };
    if let Some(address) = name.strip_prefix(TCP) {
        return Ok((Box::new(dial(address)?), name));
    }
    let mut port = open_at(&name, BAUD)?;
    // What was sent to nobody would be taken for the newest.
    let _ = port.clear(serialport::ClearBuffer::Input);
    // Some boards and systems wait for it before they send.
    let _ = port.write_data_terminal_ready(true);
    Ok((Box::new(port), name))
}

/// Opens a serial port at this speed.
///
/// # Errors
///
/// Why it does not open.
pub fn open_at(name: &str, baud: u32) -> Result<Box<dyn serialport::SerialPort>, Failure> {
    attempt(name, baud).map_err(|(_, failure)| failure)
}

/// Whether a serial port can be had: opens it and lets go of it again.
///
/// # Errors
///
/// Why it does not open, in short and in a sentence.
pub fn try_port(name: &str) -> Result<(), (Cause, Failure)> {
    attempt(name, BAUD).map(drop)
}

fn attempt(name: &str, baud: u32) -> Result<Box<dyn serialport::SerialPort>, (Cause, Failure)> {
    serialport::new(name, baud)
        .timeout(PATIENCE)
        .open()
        .map_err(|error| trouble::opening(name, &error))
}

fn dial(address: &str) -> Result<TcpStream, Failure> {
    let connect = || {
        let stream = TcpStream::connect(address)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        Ok(stream)
    };
    connect().map_err(|error: io::Error| {
        Failure::new(
            Kind::Board,
            format!("nothing answers at {TCP}{address}: {error}; start it with `cargo emulate --tcp PORT` and give --port {TCP}127.0.0.1:PORT"),
        )
    })
}
