//! The stream read again: bytes in, in whatever chunks they come, orientations and lines out.
//!
//! Both formats are read at once, so nobody has to say which is coming. What is damaged or makes no
//! sense is thrown away and counted, up to the next newline or zero: there the next line or frame
//! begins, whatever was before it. It never panics, and holds one line.
//!
//! ```
//! use vrduino::wire::decoder::{Decoder, Event};
//!
//! let mut decoder = Decoder::new();
//! let mut angles = Vec::new();
//! for &byte in b"7 0.707\nQC 0.707 0.000 0.707 0.000\n" {
//!     match decoder.push(byte) {
//!         Some(Event::Orientation(received)) => angles.push(received.orientation.angle().to_degrees()),
//!         Some(Event::Text(line)) => println!("{line}"), // here the end of a line that had begun before
//!         Some(_) | None => {}
//!     }
//! }
//! assert!((angles[0] - 90.0).abs() < 1e-9);
//! ```

mod course;

mod losses;

use super::frame::{self, Counts, Damage, Message, STUFFED_LEN};
use super::{LINE_LEN, Provenance, Stamp, Status};
use crate::orientation::quaternion;
use heapless::Vec;
use nalgebra::{Quaternion, UnitQuaternion};

pub use losses::Losses;

/// How far the length of a quaternion may be from 1. Three decimals leave it within 0.001.
const TOLERANCE: f64 = 0.01;

/// No line has a byte below it, but tabs and its end; every frame begins with one.
const FIRST_LETTER: u8 = 32;

/// What has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event<'a> {
    /// Where the board points.
    Orientation(Received),
    /// What the sensor's registers held.
    Counts(Counts, Stamp),
    /// Any other line, without its end.
    Text(&'a str),
    /// A whole frame of a kind that is not known here: from a newer board.
    Unknown(u8),
}

/// An orientation as it came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Received {
    /// Body to world, of unit length again (course notes, section 5.4).
    pub orientation: UnitQuaternion<f64>,
    /// w, x, y, z before that: exactly what was sent.
    pub components: [f64; 4],
    /// Which, and when; the course's plain line does not say.
    pub stamp: Option<Stamp>,
    /// How far to be trusted; no line says.
    pub status: Option<Status>,
}

/// Where the next byte belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// In a line, at its start at first.
    Line,
    /// Behind a zero: a frame begins, or a line.
    Open,
    Frame,
    /// In something that has been thrown away, up to its end.
    Noise,
}

/// Takes the stream byte by byte.
#[derive(Clone, Debug)]
pub struct Decoder {
    place: Place,
    bytes: Vec<u8, LINE_LEN>,
    /// What is in `bytes` is an event's, to be cleared with the next byte.
    handed_out: bool,
    /// The orientation before had a stamp.
    stamped: bool,
    losses: Losses,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// At the start of a stream, or anywhere in it.
    pub const fn new() -> Self {
        Self {
            place: Place::Line,
            bytes: Vec::new(),
            handed_out: false,
            stamped: false,
            losses: Losses::none(),
        }
    }

    /// What was lost so far.
    pub fn losses(&self) -> &Losses {
        &self.losses
    }

    /// Takes one byte; the last of a line or frame makes an event.
    pub fn push(&mut self, byte: u8) -> Option<Event<'_>> {
        if self.handed_out {
            self.bytes.clear();
            self.handed_out = false;
        }
        match (self.place, byte) {
            (Place::Frame, 0) => {
                self.place = Place::Open;
                let event = self.frame();
                return self.settle(event);
            }
            (Place::Line, b'\n') => {
                if self.bytes.last() == Some(&b'\r') {
                    self.bytes.pop();
                }
                return self.end_of_line();
            }
            (Place::Line, 0) => {
                // A line that finds no end.
                if !self.bytes.is_empty() {
                    self.losses.refuse(Damage::Malformed, self.bytes.len());
                    self.bytes.clear();
                }
                self.place = Place::Open;
            }
            (Place::Open | Place::Noise, 0) => self.place = Place::Open,
            (Place::Noise, b'\n') => self.place = Place::Line,
            (Place::Noise, _) => self.losses.bytes += 1,
            (Place::Open, ..FIRST_LETTER) => self.take(byte, Place::Frame),
            (Place::Line, ..FIRST_LETTER) if !matches!(byte, b'\r' | b'\t') => self.give_up(),
            (Place::Frame, _) if self.bytes.len() == STUFFED_LEN => self.give_up(),
            (Place::Frame, _) => self.take(byte, Place::Frame),
            (Place::Open | Place::Line, _) => self.take(byte, Place::Line),
        }
        None
    }

    fn take(&mut self, byte: u8, place: Place) {
        self.place = place;
        if self.bytes.push(byte).is_err() {
            self.give_up();
        }
    }

    /// Neither line nor frame goes on like this.
    fn give_up(&mut self) {
        // With the byte that makes it so.
        self.losses.refuse(Damage::Malformed, self.bytes.len() + 1);
        self.bytes.clear();
        self.place = Place::Noise;
    }

    fn frame(&self) -> Result<Event<'static>, Damage> {
        Ok(match frame::parse(&self.bytes)? {
            Message::Orientation(q, Provenance { stamp, status }) => {
                Event::Orientation(received(q.components(), Some(stamp), Some(status))?)
            }
            Message::Counts(counts, stamp) => Event::Counts(counts, stamp),
            Message::Unknown(kind) => Event::Unknown(kind),
        })
    }

    fn end_of_line(&mut self) -> Option<Event<'_>> {
        if self.bytes.is_empty() {
            return None;
        }
        let event = match core::str::from_utf8(&self.bytes).map(course::parse) {
            Ok(None) => {
                self.handed_out = true;
                return core::str::from_utf8(&self.bytes).ok().map(Event::Text);
            }
            Ok(Some(Ok((components, stamp)))) => {
                received(components, stamp, None).map(Event::Orientation)
            }
            Ok(Some(Err(damage))) => Err(damage),
            Err(_) => Err(Damage::Malformed),
        };
        self.settle(event)
    }

    fn settle(&mut self, event: Result<Event<'static>, Damage>) -> Option<Event<'static>> {
        let event = event.and_then(|event| self.follow(event));
        if let Err(damage) = event {
            self.losses.refuse(damage, self.bytes.len());
        }
        self.bytes.clear();
        event.ok()
    }

    /// A plain line behind an orientation with a stamp is rather the beginning of a line whose end is damaged:
    /// only a second one is believed.
    fn follow(&mut self, event: Event<'static>) -> Result<Event<'static>, Damage> {
        if let Event::Orientation(Received { stamp, .. }) = event {
            let before = core::mem::replace(&mut self.stamped, stamp.is_some());
            match stamp {
                Some(stamp) => self.losses.follow(stamp.sequence),
                None if before => return Err(Damage::Malformed),
                None => {}
            }
        }
        Ok(event)
    }
}

/// None of these is a rotation if its length is far from 1.
fn received(
    components: [f64; 4],
    stamp: Option<Stamp>,
    status: Option<Status>,
) -> Result<Received, Damage> {
    let [w, x, y, z] = components;
    let q = Quaternion::new(w, x, y, z);
    let near_one = (q.norm() - 1.0).abs() <= TOLERANCE;
    let orientation = quaternion::unit(q).filter(|_| near_one);
    Ok(Received {
        orientation: orientation.ok_or(Damage::Malformed)?,
        components,
        stamp,
        status,
    })
}
