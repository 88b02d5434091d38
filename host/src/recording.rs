//! Recordings: a stream in a file, with everything it takes to play it again.
//!
//! ```text
//! items ──assembly──► entries ──writer──► file ──reader──► entries ──encoding──► bytes
//! ```
//!
//! The file is CSV with comment lines, or Parquet with the same columns; `docs/recordings.md` is the
//! specification, and `columns` the only place that knows what stands in a row.

mod assembly;

mod columns;

mod csv;

mod encoding;

mod head;

mod lines;

#[cfg(feature = "parquet")]
pub mod parquet;

mod player;

mod reader;

mod writer;

use vrduino::wire::frame::Counts;

use crate::stream::Sample;
pub use assembly::Assembly;
pub use encoding::{Format, encode};
pub use head::Head;
pub use player::{Batch, Player};
pub use reader::{Ending, Reader};
pub use writer::Writer;

/// The format described here. A file of another one is not read.
pub const VERSION: u32 = 1;

/// What every recording begins with, before its version.
const SIGNATURE: &str = "# vrduino recording ";

/// What a recording is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// A row.
    Row(Row),
    /// Anything else, in its place between the rows.
    Remark(Remark),
}

/// An orientation, and what it was made of if that was recorded. [`Sample::is_first`] begins a segment:
/// times in it have nothing to do with those before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The orientation.
    pub sample: Sample,
    /// The sensor's registers.
    pub registers: Option<Counts>,
}

/// What stands between the rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    /// When, in s on the source's clock: the arrival of the sample before it.
    pub at: f64,
    /// Whose words.
    pub voice: Voice,
    /// What was said, in one line.
    pub text: String,
}

/// Who speaks between the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Voice {
    /// The board: a line of the stream.
    Board,
    /// Whoever recorded it.
    Recorder,
}

impl Voice {
    const ALL: [Self; 2] = [Self::Board, Self::Recorder];

    /// The word it goes by in a file.
    fn word(self) -> &'static str {
        match self {
            Self::Board => "line",
            Self::Recorder => "note",
        }
    }
}

impl Remark {
    /// A remark, in one line whatever it holds.
    pub fn new(at: f64, voice: Voice, text: &str) -> Self {
        Self {
            at,
            voice,
            text: one_line(text),
        }
    }
}

/// Control characters would end a line, here or in somebody's data frame.
fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect::<String>()
        .trim()
        .to_owned()
}
