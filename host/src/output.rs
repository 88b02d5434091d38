//! Standard output, which whoever reads it may close.

use std::io::{self, IsTerminal, Write};

use crate::failure::Failure;

/// Standard output. Once it is closed, what is written is thrown away, and whoever writes for long looks
/// whether it is.
#[derive(Debug, Default)]
pub struct Output {
    closed: bool,
}

impl Output {
    /// Standard output.
    pub fn new() -> Self {
        Self::default()
    }

    /// A line, or several.
    pub fn say(&mut self, text: impl AsRef<str>) {
        if !self.closed {
            let mut output = io::stdout().lock();
            let written = writeln!(output, "{}", text.as_ref()).and_then(|()| output.flush());
            self.closed = written.is_err();
        }
    }

    /// Whether nobody reads it any more: a normal end.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Whether it is shown to somebody who can answer.
    pub fn is_terminal() -> bool {
        io::stdout().is_terminal() && io::stdin().is_terminal()
    }

    /// Asks, and takes an `y` or `yes` for yes.
    ///
    /// # Errors
    ///
    /// Standard input cannot be read.
    pub fn ask(&mut self, question: &str) -> Result<bool, Failure> {
        let mut output = io::stdout().lock();
        let _ = write!(output, "{question} [y/N] ").and_then(|()| output.flush());
        let mut answer = String::new();
        io::stdin().read_line(&mut answer).map_err(|error| {
            let sentence = format!("no answer can be read: {error}; say --yes beforehand");
            Failure::new(crate::failure::Kind::Computer, sentence)
        })?;
        Ok(matches!(answer.trim(), "y" | "Y" | "yes" | "Yes"))
    }
}
