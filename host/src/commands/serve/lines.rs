//! The board's lines, verbatim, as the course's server takes them from the port.

use super::frames::Frames;
use crate::hub::{State, Update};
use crate::stream::Item;

/// Bytes of a line at most; the board's have 160.
const LONGEST: usize = 1024;

/// Bytes of a frame at most, between its zeros (docs/wire-format.md).
const LONGEST_FRAME: usize = 31;

/// Where the next byte belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    Line,
    /// Behind a zero: a frame begins, or a line.
    Open,
    /// In a frame, of which so many bytes have come.
    Frame(usize),
}

/// Takes lines out of bytes.
#[derive(Debug)]
pub struct Lines {
    place: Place,
    line: Vec<u8>,
    /// The line that is going on will be no good.
    is_spoilt: bool,
    frames: Frames,
}

impl Lines {
    /// Of bytes that begin with a line.
    pub fn from_the_beginning() -> Self {
        Self {
            place: Place::Line,
            line: Vec::new(),
            is_spoilt: false,
            frames: Frames::default(),
        }
    }

    /// Of bytes that begin anywhere: what comes before the first newline is half a line.
    pub fn from_anywhere() -> Self {
        Self {
            is_spoilt: true,
            ..Self::from_the_beginning()
        }
    }

    /// The lines that this brings, without their newlines.
    pub fn of(&mut self, update: &Update) -> Vec<String> {
        match update {
            Update::Bytes(bytes) => self.take(bytes),
            Update::Stream(items) => {
                let samples = items.iter().filter_map(|item| match item {
                    Item::Sample(sample) => Some(sample),
                    _ => None,
                });
                samples
                    .filter_map(|sample| self.frames.take(sample))
                    .collect()
            }
            Update::Status(status) => {
                if status.state != State::Connected {
                    *self = Self::from_the_beginning();
                }
                Vec::new()
            }
            Update::Truth(_) | Update::Ended(_) => Vec::new(),
        }
    }

    /// The lines that these bytes complete. What is no text is left out: frames and garbage.
    fn take(&mut self, bytes: &[u8]) -> Vec<String> {
        bytes.iter().filter_map(|&byte| self.push(byte)).collect()
    }

    fn push(&mut self, byte: u8) -> Option<String> {
        self.place = match (self.place, byte) {
            (_, 0) => {
                self.line.clear();
                self.is_spoilt = false;
                Place::Open
            }
            (Place::Open, 1..32) => Place::Frame(1),
            (Place::Frame(count), _) if count < LONGEST_FRAME => Place::Frame(count + 1),
            (Place::Frame(_), _) => {
                self.is_spoilt = true;
                Place::Line
            }
            (Place::Line | Place::Open, _) => Place::Line,
        };
        match (self.place, byte) {
            (Place::Line, b'\n') => {
                let line = std::mem::take(&mut self.line);
                let is_whole = !std::mem::take(&mut self.is_spoilt);
                return String::from_utf8(line).ok().filter(|_| is_whole);
            }
            (Place::Line, b'\t' | b'\r' | b' '..=b'~' | 0x80..) if self.line.len() < LONGEST => {
                self.line.push(byte);
            }
            (Place::Line, _) => self.is_spoilt = true,
            (Place::Open | Place::Frame(_), _) => {}
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::Lines;

    #[test]
    fn lines_come_as_they_are_in_whatever_pieces() {
        let text = "QC 1.000 0.000 0.000 0.000\n\nEA\t1 2 3\r\nµ\n";
        let expected = ["QC 1.000 0.000 0.000 0.000", "", "EA\t1 2 3\r", "µ"];
        for length in 1..text.len() {
            let mut lines = Lines::from_the_beginning();
            let found: Vec<_> = text
                .as_bytes()
                .chunks(length)
                .flat_map(|bytes| lines.take(bytes))
                .collect();
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn half_lines_frames_and_garbage_are_left_out() {
        let mut lines = Lines::from_anywhere();
        assert!(lines.take(b"0.000 0.000").is_empty());
        assert_eq!(lines.take(b"\nwhole\n"), ["whole"]);
        // Frames with newlines in them, then an answer.
        let frames = b"\0\x04\x01\x50QC \n{\n\x04abc\0\0\n\n\n\0OK stream text every 10\n";
        assert_eq!(lines.take(frames), ["OK stream text every 10"]);
        assert!(lines.take(b"\xff\xfe\n\x1b[0m\n").is_empty());
        assert!(lines.take(&[b'x'; 5000]).is_empty());
        assert_eq!(lines.take(b"\nafter it\n"), ["after it"]);
        // A zero that begins no frame is one line's loss, or two's.
        assert!(lines.take(b"half\0\x01").is_empty());
        assert!(lines.take(&[b'x'; 31]).is_empty());
        assert_eq!(lines.take(b"\nafter it\n"), ["after it"]);
    }
}
