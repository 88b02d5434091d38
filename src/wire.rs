//! What goes to the host, to the byte: `docs/wire-format.md` is the specification.
//!
//! | file | what it is |
//! |---|---|
//! | `lines` | the course's lines and those for people |
//! | `orientation` | `QC w x y z`, the course's line, and the same with its provenance |
//! | `from_the_end` | its digits, in the order they come |
//! | `q30` | the quaternion as the wire takes it |
//! | `provenance` | which orientation, of which moment, and how far it is to be trusted |
//! | `frame` | the same in binary |
//! | `cobs`, `crc` | bytes without a zero among them, and how damage is found |
//! | `decoder` | all of it read again, whatever comes between |
//!
//! A line is a tag, numbers separated by single spaces, and a newline. (The course's web pages split on one space and
//! give up on a tab; its Unity script wants a whole line in every 64 bytes.) Every function returns
//! one whole line or frame, ready to be sent or dropped as one.

pub mod lines;

pub mod orientation;

mod from_the_end;

pub mod q30;

pub mod provenance;

pub mod frame;

pub mod cobs;

pub mod crc;

pub mod decoder;

pub use lines::*;
pub use orientation::{Decimals, Tag, quaternion, timed};
pub use provenance::{Provenance, Stamp, Status};
pub use q30::Q30;

use crate::decimal::{Decimal, write_digits};
use core::fmt::{self, Write};
use heapless::String;

/// One line, newline included.
pub type Line = String<LINE_LEN>;

/// Longest line in bytes, newline included.
pub const LINE_LEN: usize = 160;

/// Most bytes of an orientation on the wire, as a line or as a frame: one packet of the serial port. A
/// packet of all the 64 bytes that USB allows would want an empty one behind it.
pub const PACKET_LEN: usize = 63;

/// A message for people. What does not fit into a line is cut off; a newline within becomes a
/// space, or one line would be two.
pub fn text(message: impl fmt::Display) -> Line {
    struct Cut(Line);
    impl Write for Cut {
        fn write_str(&mut self, s: &str) -> fmt::Result {
            for c in s.chars() {
                let c = if c.is_control() { ' ' } else { c };
                // The last byte is the newline's.
                if self.0.len() + c.len_utf8() >= LINE_LEN {
                    return Err(fmt::Error);
                }
                self.0.push(c).map_err(|_| fmt::Error)?;
            }
            Ok(())
        }
    }
    let mut cut = Cut(Line::new());
    // An error only says that the rest did not fit.
    let _ = write!(cut, "{message}");
    end(cut.0)
}

fn end(mut line: Line) -> Line {
    push(&mut line, "\n");
    line
}

/// No line here can be longer than [`LINE_LEN`]: the longest, of three numbers, stays under 60.
fn push(line: &mut Line, s: &str) {
    let _ = line.push_str(s);
}

/// No number is too long for a line.
fn push_decimal(line: &mut Line, value: f32, decimals: u32) {
    let _ = Decimal(value, decimals).write_to(line);
}

fn push_digits(line: &mut Line, value: u64, width: usize) {
    let _ = write_digits(line, value, width);
}
