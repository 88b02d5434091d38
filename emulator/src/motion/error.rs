//! What can be wrong with a motion that comes from outside.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a motion cannot be used. Every message says what to do about it.
#[derive(Debug)]
#[non_exhaustive]
pub enum MotionError {
    /// The problem, with the file it was found in.
    InFile {
        /// The file, as it was named.
        path: PathBuf,
        /// What is wrong with it.
        problem: Box<MotionError>,
    },
    /// The file cannot be read.
    Read(io::Error),
    /// The file is larger than any motion should be.
    TooLong {
        /// The largest size that is read (bytes).
        limit: u64,
    },
    /// The file holds nothing, or nothing but comments.
    Empty,
    /// The file is neither a recording with the `IMUB` magic nor text.
    NotAMotion {
        /// Where the first byte that cannot be text stands.
        offset: usize,
    },
    /// A binary recording of a version or header size this program does not know.
    Version {
        /// The version in the header.
        version: u16,
        /// The header size in the header (bytes).
        header: u16,
    },
    /// A binary recording whose length does not follow from its header.
    Length {
        /// The length the header promises (bytes).
        expected: u64,
        /// The length of the file (bytes).
        found: u64,
    },
    /// A header field of a binary recording with an impossible value.
    Header {
        /// The field's name.
        field: &'static str,
        /// Its value, and what would be possible.
        value: String,
    },
    /// A record whose orientation is marked valid but is not a rotation.
    Reference {
        /// Number of the record, from 0.
        record: usize,
    },
    /// A table whose line of column names is wrong.
    Columns {
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// Something in a text file is not as it should be.
    Text {
        /// The line, from 1.
        line: usize,
        /// The character in the line, from 1.
        column: usize,
        /// What is wrong there.
        problem: String,
    },
    /// Bare rows whose numbers do not come in groups of six.
    Rows {
        /// How many numbers there are.
        numbers: usize,
    },
    /// A start that lies outside the motion.
    Start {
        /// The start that was asked for (s).
        start: f64,
        /// How long the motion lasts (s), if it ends.
        duration: Option<f64>,
    },
}

impl MotionError {
    pub(super) fn in_file(self, path: &Path) -> Self {
        Self::InFile {
            path: path.to_path_buf(),
            problem: Box::new(self),
        }
    }
}

impl fmt::Display for MotionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InFile { path, problem } => write!(f, "{}: {problem}", path.display()),
            Self::Read(error) => write!(
                f,
                "cannot read the motion: {error}; give an existing file that may be read"
            ),
            Self::TooLong { limit } => write!(
                f,
                "longer than {} MiB, too long for a motion; cut it into shorter ones",
                limit / (1024 * 1024)
            ),
            Self::Empty => write!(
                f,
                "there is no motion in it; give a recording with at least one sample"
            ),
            Self::NotAMotion { offset } => write!(
                f,
                "not a motion: byte {offset} is not text and the file does not begin with IMUB; \
                 give an .imub recording, a table with the columns t,gx,gy,gz,ax,ay,az, or rows of six numbers"
            ),
            Self::Version { version, header } => write!(
                f,
                "an IMUB recording of version {version} with a header of {header} bytes; \
                 only version 1 with 64 bytes is known, export it again as that"
            ),
            Self::Length { expected, found } => write!(
                f,
                "the header promises {expected} bytes but the file has {found}: it is damaged or cut; copy it again"
            ),
            Self::Header { field, value } => write!(
                f,
                "the header's {field} is {value}; the file is damaged, copy or export it again"
            ),
            Self::Reference { record } => write!(
                f,
                "record {record} marks its orientation as valid but it is not a rotation; export the recording again"
            ),
            Self::Columns { line, problem } => write!(
                f,
                "line {line}: {problem}; the first line names the columns t,gx,gy,gz,ax,ay,az and, \
                 if the truth is known, qw,qx,qy,qz"
            ),
            Self::Text {
                line,
                column,
                problem,
            } => write!(f, "line {line}, column {column}: {problem}"),
            Self::Rows { numbers } => write!(
                f,
                "{numbers} numbers do not make rows of six (gyroscope x, y, z in °/s, accelerometer x, y, z in m/s²); \
                 a value is missing or too many"
            ),
            Self::Start { start, duration } => match duration {
                Some(duration) => write!(
                    f,
                    "cannot start at {start} s: the motion lasts {duration:.3} s; give a start from 0 to less than that"
                ),
                None => write!(f, "cannot start at {start} s: give a start of 0 s or later"),
            },
        }
    }
}

impl Error for MotionError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Read(error) => Some(error),
            _ => None,
        }
    }
}
