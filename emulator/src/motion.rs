//! What the sensor experiences: the motion that the simulated MPU-9250 is carried through.
//!
//! A [`Motion`] answers one question, "what does the sensor feel at this instant?", in physical
//! units and in the sensor's own axes. Turning that into register counts (scale, range, filter,
//! sample rate) is the sensor model's business.
//!
//! Frames: the *body* frame is the sensor's own, x, y and z as the registers name them. The *world*
//! frame is right-handed with y up, so a level sensor at rest reads (0, +9.81, 0) m/s².
//!
//! ```no_run
//! use vrduino_emulator::motion;
//!
//! let recording = motion::open("walk.imub".as_ref())?;
//! let motion = motion::skip(recording, 30.0)?;
//! println!("{}: {:?}", motion.describe(), motion.at(0.25).rate);
//! # Ok::<(), motion::MotionError>(())
//! ```

use std::fs::File;
use std::io::Read;
use std::path::Path;

pub mod course;

pub mod csv;

mod error;

pub mod head;

pub mod imperfections;

pub mod imub;

pub mod magnetic;

mod recording;

pub mod rotation;

mod skip;

pub mod turns;

pub use error::MotionError;
pub use head::Head;
pub use imperfections::{Imperfect, Imperfections};
pub use recording::Recording;
pub use skip::{Skipped, skip};
pub use turns::Turns;

/// Gravity of the generated motions (m/s²), along the world's y axis.
///
/// Rounded as in the field's textbooks; no consumer of an accelerometer resolves the difference to
/// the standard value.
pub const GRAVITY: f64 = 9.81;

/// The largest motion file that is read (bytes): hours of recording, and far from filling a memory.
const FILE_LIMIT: u64 = 256 * 1024 * 1024;

/// One instant of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// Angular rate about the body axes (rad/s), right-handed.
    pub rate: [f64; 3],
    /// Specific force along the body axes (m/s²): what an accelerometer reads, +9.81 on the upward
    /// axis at rest.
    pub force: [f64; 3],
    /// Magnetic flux density along the body axes (µT), where it was recorded; see
    /// [`Instant::magnetic_field`].
    pub field: Option<[f64; 3]>,
    /// The true rotation body → world (y up), a unit quaternion w, x, y, z, where it is known.
    pub truth: Option<[f64; 4]>,
}

/// A motion the sensor is carried through.
///
/// It can be asked by several at once: a snapshot of a board shares its motion with the original.
pub trait Motion: Send + Sync {
    /// What the sensor feels `t` seconds after the motion began.
    ///
    /// Any order of times is allowed and the answer depends on `t` alone, so that two runs of the
    /// emulator see the same motion however they sample it. A negative time counts as zero.
    fn at(&self, t: f64) -> Instant;

    /// How long the motion lasts (s); `None` if it never ends.
    ///
    /// A motion may be asked beyond its end: the sensor then lies still where it was left.
    fn duration(&self) -> Option<f64>;

    /// A line for people: what this motion is, and how long it lasts.
    fn describe(&self) -> String;
}

/// By its description: what a sensor is carried through is no state of it.
impl std::fmt::Debug for dyn Motion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.describe())
    }
}

/// The motion used when none is named: a [`Head`] looking around, seen by an imperfect sensor.
pub fn built_in() -> Box<dyn Motion> {
    Box::new(Imperfect::new(
        Box::new(Head::new()),
        Imperfections::default(),
    ))
}

/// Opens a recorded motion, whatever its kind.
///
/// The content decides: the magic bytes `IMUB` mark a [binary recording](imub), a line of column
/// names a [table](csv), and bare numbers or a C array are the [course's rows](course).
///
/// # Errors
///
/// [`MotionError::InFile`] with the path and what is wrong: it cannot be read, is none of the three
/// kinds, or breaks the rules of its kind.
pub fn open(path: &Path) -> Result<Box<dyn Motion>, MotionError> {
    read(path)
        .and_then(|bytes| parse(&bytes))
        .map(|recording| -> Box<dyn Motion> { Box::new(recording.named(file_name(path))) })
        .map_err(|problem| problem.in_file(path))
}

/// Reads a recorded motion from the bytes of a file, whatever its kind; see [`open`].
///
/// # Errors
///
/// What is wrong with the bytes, without a path.
pub fn parse(bytes: &[u8]) -> Result<Recording, MotionError> {
    if bytes.is_empty() {
        return Err(MotionError::Empty);
    }
    if bytes.starts_with(imub::MAGIC) {
        return imub::parse(bytes);
    }
    let text = std::str::from_utf8(bytes).map_err(|error| MotionError::NotAMotion {
        offset: error.valid_up_to(),
    })?;
    // A control character is no more text than a broken UTF-8 sequence is.
    if let Some(offset) = text.find(|c: char| c.is_control() && !c.is_whitespace()) {
        return Err(MotionError::NotAMotion { offset });
    }
    if course::looks_like_rows(text) {
        course::parse(text)
    } else {
        csv::parse(text)
    }
}

fn read(path: &Path) -> Result<Vec<u8>, MotionError> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(FILE_LIMIT + 1).read_to_end(&mut bytes))
        .map_err(MotionError::Read)?;
    if bytes.len() as u64 > FILE_LIMIT {
        return Err(MotionError::TooLong { limit: FILE_LIMIT });
    }
    Ok(bytes)
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(
        || path.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    )
}
