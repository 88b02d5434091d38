//! A text file, line by line, none of which can fill the memory.

use std::io::{self, BufRead, Read};

/// No line of a recording is as long: the board's have 160 bytes at most, a row some 200.
pub const LONGEST: usize = 4096;

/// A line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line<'a> {
    /// Counted from 1.
    pub number: u64,
    /// Without its end.
    pub text: &'a str,
    /// It has an end. The last line of a file that is cut off has none.
    pub is_whole: bool,
}

/// Why there is no line. But for the first, there may be another behind it.
#[derive(Debug)]
pub enum Trouble {
    /// The file cannot be read.
    Io(io::Error),
    /// The line of this number is too long.
    TooLong(u64),
    /// The line of this number is not text.
    NotText(u64),
}

/// Reads them.
#[derive(Debug)]
pub struct Lines<R> {
    input: R,
    bytes: Vec<u8>,
    number: u64,
}

impl<R: BufRead> Lines<R> {
    /// Of this file.
    pub fn new(input: R) -> Self {
        Self {
            input,
            bytes: Vec::new(),
            number: 0,
        }
    }

    /// The next.
    pub fn next(&mut self) -> Result<Option<Line<'_>>, Trouble> {
        self.bytes.clear();
        let mut input = (&mut self.input).take(LONGEST as u64 + 1);
        let count = input.read_until(b'\n', &mut self.bytes);
        if count.map_err(Trouble::Io)? == 0 {
            return Ok(None);
        }
        self.number += 1;
        let number = self.number;
        if self.bytes.len() > LONGEST {
            if self.bytes.last() != Some(&b'\n') {
                self.skip_line().map_err(Trouble::Io)?;
            }
            return Err(Trouble::TooLong(number));
        }
        let is_whole = self.bytes.last() == Some(&b'\n');
        let text = match (str::from_utf8(&self.bytes), is_whole) {
            (Ok(text), _) => text.trim_end_matches(['\n', '\r']),
            // It may have been cut within a letter.
            (Err(_), false) => "",
            (Err(_), true) => return Err(Trouble::NotText(number)),
        };
        Ok(Some(Line {
            number,
            text,
            is_whole,
        }))
    }

    /// To the end of this one, a piece at a time.
    fn skip_line(&mut self) -> io::Result<()> {
        loop {
            let buffer = self.input.fill_buf()?;
            let end = buffer.iter().position(|&byte| byte == b'\n');
            let count = end.map_or(buffer.len(), |end| end + 1);
            let is_over = end.is_some() || buffer.is_empty();
            self.input.consume(count);
            if is_over {
                return Ok(());
            }
        }
    }
}
