//! Standard output, which whoever reads it may close.

use std::io::{self, IsTerminal, Write};
use std::sync::mpsc::{self, TryRecvError};
use std::thread;

use crate::failure::{Failure, Kind};

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

    /// Asks, and takes `y` or `yes` for yes. `wait` is what happens meanwhile, a little at a time; once it
    /// says no, no answer is waited for any more, and there is none.
    ///
    /// # Errors
    ///
    /// Standard input cannot be read.
    pub fn ask(
        &mut self,
        question: &str,
        mut wait: impl FnMut() -> bool,
    ) -> Result<Option<bool>, Failure> {
        {
            let mut output = io::stdout().lock();
            let _ = write!(output, "{question} [y/N] ").and_then(|()| output.flush());
        }
        let unreadable = |why: String| {
            let sentence = format!("no answer can be read: {why}; say --yes beforehand");
            Failure::new(Kind::Computer, sentence)
        };
        let (heard, answers) = mpsc::channel();
        // Nothing but an answer ends it, Ctrl-C neither: it is left behind, and the program's end is its own.
        thread::spawn(move || {
            let mut answer = String::new();
            let read = io::stdin().read_line(&mut answer);
            // Whoever asked may have gone on.
            let _ = heard.send(read.map(|_| answer));
        });
        loop {
            match answers.try_recv() {
                Ok(Ok(answer)) => {
                    let agreed = matches!(answer.trim(), "y" | "Y" | "yes" | "Yes");
                    return Ok(Some(agreed));
                }
                Ok(Err(error)) => return Err(unreadable(error.to_string())),
                Err(TryRecvError::Disconnected) => {
                    return Err(unreadable("standard input is closed".into()));
                }
                Err(TryRecvError::Empty) => {}
            }
            if !wait() {
                return Ok(None);
            }
        }
    }
}
