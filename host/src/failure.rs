//! Why a command ends: a sentence that says what to do, and an exit code.

use std::fmt;
use std::io;
use std::process::ExitCode;

/// What went wrong. The number is the program's exit code; 2 is a mistake on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// `doctor` has found something that is not as it should be.
    Finding = 1,
    /// There is no board, or its port cannot be had.
    Board = 3,
    /// The board is there, and what it sends is not what was wanted.
    Stream = 4,
    /// A file cannot be read or written, or does not hold what it should.
    File = 5,
    /// Something else on this computer: another program, a port of the network, the image.
    Computer = 6,
}

impl Kind {
    /// All of them, in words: what `vrduino --help` says about exit codes.
    pub const MEANINGS: &str = "\
Exit codes: 0 done · 1 doctor found something wrong · 2 a mistake on the command line · 3 no board, or its port cannot be had · \
4 the stream is not what was wanted · 5 a file · 6 something else on this computer";
}

/// Why a command ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What kind of thing went wrong.
    pub kind: Kind,
    /// What is wrong and what to do about it.
    pub sentence: String,
}

impl Failure {
    /// A failure of this kind.
    pub fn new(kind: Kind, sentence: impl Into<String>) -> Self {
        Self {
            kind,
            sentence: sentence.into(),
        }
    }

    /// The exit code.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.kind as u8)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence)
    }
}

impl std::error::Error for Failure {}

/// Whether a read or a write with a time limit has only had no turn yet: to be tried again.
pub(crate) fn is_not_yet(error: &io::Error) -> bool {
    use io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), Interrupted | TimedOut | WouldBlock)
}
