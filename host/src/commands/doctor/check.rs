//! What was looked at, and what came of it.

use crate::failure::{Failure, Kind};
use crate::output::Output;

/// Told as it grows.
#[derive(Debug)]
pub struct Report {
    output: Output,
    doubts: usize,
    /// What to do, where something has to be done.
    wrong: Vec<String>,
}

impl Report {
    /// Nothing looked at yet.
    pub fn new(output: Output) -> Self {
        Self {
            output,
            doubts: 0,
            wrong: Vec::new(),
        }
    }

    /// As it should be.
    pub fn good(&mut self, what: impl AsRef<str>) {
        self.output.say(format!("✓ {}", what.as_ref()));
    }

    /// Not good, not bad.
    pub fn note(&mut self, what: impl AsRef<str>) {
        self.output.say(format!("  {}", what.as_ref()));
    }

    /// It may become a nuisance, and this can be done about it.
    pub fn doubt(&mut self, what: impl AsRef<str>, advice: impl AsRef<str>) {
        self.doubts += 1;
        self.output.say(format!("! {}", what.as_ref()));
        self.advise(advice.as_ref());
    }

    /// It has to be mended, and so.
    pub fn bad(&mut self, what: impl AsRef<str>, advice: impl AsRef<str>) {
        self.output.say(format!("✗ {}", what.as_ref()));
        self.advise(advice.as_ref());
        let first = advice.as_ref().lines().next().unwrap_or_default();
        self.wrong.push(first.trim_end_matches(':').to_owned());
    }

    fn advise(&mut self, advice: &str) {
        for (number, line) in advice.lines().enumerate() {
            let arrow = if number == 0 { "→" } else { " " };
            self.output.say(format!("    {arrow} {line}"));
        }
    }

    /// What comes to mind once all was looked at.
    ///
    /// # Errors
    ///
    /// Something is wrong.
    pub fn end(mut self) -> Result<(), Failure> {
        self.output.say("");
        let Some(first) = self.wrong.first() else {
            self.output.say(match self.doubts {
                0 => "Nothing is wrong. Next: `vrduino view`.",
                _ => "Nothing keeps it from working; what is marked ! may become a nuisance. Next: `vrduino view`.",
            });
            return Ok(());
        };
        self.output
            .say(format!("Next: {first}; then run this again."));
        let sentence = match self.wrong.len() {
            1 => "something is wrong: see ✗ above".to_owned(),
            count => format!("{count} things are wrong: see ✗ above, and begin with the first"),
        };
        Err(Failure::new(Kind::Finding, sentence))
    }
}
