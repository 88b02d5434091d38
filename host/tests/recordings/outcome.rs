//! What comes of a run of the program.

use crate::program::Program;

/// How it ended, and what it said.
#[derive(Debug)]
pub struct Outcome {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

/// Runs it with these words.
pub fn vrduino(words: &[&str]) -> Outcome {
    let ended = Program::start(words).end();
    Outcome {
        code: ended.code,
        out: ended.said.join("\n") + "\n",
        err: ended.complained,
    }
}

impl Outcome {
    /// Fails unless it ended so.
    #[track_caller]
    pub fn expect(&self, code: i32) -> &Self {
        assert_eq!(self.code, Some(code), "{}{}", self.out, self.err);
        self
    }

    /// Fails unless it has said so, somewhere.
    #[track_caller]
    pub fn said(&self, words: &str) -> &Self {
        let said = self.out.contains(words) || self.err.contains(words);
        assert!(said, "not said: {words}\n{}{}", self.out, self.err);
        self
    }
}
