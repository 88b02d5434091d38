//! Runs written down, so that they can be repeated exactly: what the board was, what came from outside and when, and how
//! it ended.
//!
//! ```text
//! vrduino run 1
//! image 0123456789abcdef
//! motion 0123456789abcdef generated head motion, ...
//! board 0123456789abcdef
//! at 504000000 typed 2
//! at 720000000 fault stuck-sda on
//! end 1440000000 state 0123456789abcdef stream 23104 0123456789abcdef
//! ```
//!
//! Times are ticks of 1/144 MHz; hashes are FNV-1a. `board` is the state hash at power-on, which depends on every option
//! that changes the board.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use vrduino_emulator::board::Board;
use vrduino_emulator::hash::Fnv1a;
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::Motion;
use vrduino_emulator::time::{self, Ticks};

use super::Error;
use super::input::Input;

/// First line of a file.
const TITLE: &str = "vrduino run 1";

/// Largest file that is read (bytes).
const FILE_LIMIT: u64 = 64 * 1024 * 1024;

/// What a run depends on besides its inputs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    image: u64,
    motion: (u64, String),
    board: u64,
}

impl Origin {
    /// The image and the motion, before the board is made of them.
    pub fn new(image: &Image, motion: &dyn Motion) -> Origin {
        Origin {
            image: Fnv1a::of(&image.flash),
            motion: (motion_hash(motion), motion.describe()),
            board: 0,
        }
    }

    /// The same, with the board at power-on.
    pub fn of(self, board: &Board) -> Origin {
        Origin {
            board: board.state_hash(),
            ..self
        }
    }
}

/// A motion is known by what it does: every 10 ms of its first ten minutes.
fn motion_hash(motion: &dyn Motion) -> u64 {
    let mut hash = Fnv1a::new();
    let length = motion.duration().unwrap_or(600.0).min(600.0);
    for index in 0..=(length * 100.0) as u32 {
        let instant = motion.at(f64::from(index) / 100.0);
        for value in instant.rate.iter().chain(&instant.force) {
            hash.bytes(&value.to_bits().to_le_bytes());
        }
    }
    hash.value()
}

/// How a run has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ending {
    at: Ticks,
    state: u64,
    bytes: u64,
    stream: u64,
}

impl std::fmt::Display for Ending {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "end at {:.9} s, state {:016x}, {} bytes of stream with hash {:016x}",
            time::seconds(self.at),
            self.state,
            self.bytes,
            self.stream
        )
    }
}

/// The stream so far.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stream {
    bytes: u64,
    hash: Fnv1a,
}

impl Stream {
    /// Takes in a piece of it.
    pub fn take_in(&mut self, bytes: &[u8]) {
        self.bytes += bytes.len() as u64;
        self.hash.bytes(bytes);
    }

    /// How the run has ended, if it ends now.
    pub fn ending(&self, board: &Board) -> Ending {
        Ending {
            at: board.now(),
            state: board.state_hash(),
            bytes: self.bytes,
            stream: self.hash.value(),
        }
    }
}

/// Writes a run down.
pub struct Recorder {
    path: PathBuf,
    file: File,
}

impl Recorder {
    /// Begins a file.
    pub fn create(path: &Path, origin: &Origin) -> Result<Recorder, Error> {
        let mut recorder = Recorder {
            file: File::create(path).map_err(|error| unwritable(path, &error))?,
            path: path.to_owned(),
        };
        let (motion, description) = &origin.motion;
        recorder.write(format_args!(
            "{TITLE}\nimage {:016x}\nmotion {motion:016x} {}\nboard {:016x}\n",
            origin.image,
            description.escape_default(),
            origin.board
        ))?;
        Ok(recorder)
    }

    fn write(&mut self, text: std::fmt::Arguments<'_>) -> Result<(), Error> {
        self.file
            .write_fmt(text)
            .map_err(|error| unwritable(&self.path, &error))
    }

    /// Notes an input at its moment.
    pub fn note(&mut self, at: Ticks, input: &Input) -> Result<(), Error> {
        self.write(format_args!("at {at} {input}\n"))
    }

    /// Notes the end.
    pub fn end(&mut self, ending: Ending) -> Result<(), Error> {
        let Ending {
            at,
            state,
            bytes,
            stream,
        } = ending;
        self.write(format_args!(
            "end {at} state {state:016x} stream {bytes} {stream:016x}\n"
        ))
    }
}

fn unwritable(path: &Path, error: &io::Error) -> Error {
    format!("{} cannot be written: {error}", path.display()).into()
}

/// A run that was written down.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Replay {
    path: PathBuf,
    origin: Origin,
    /// Inputs that are still to come, in order.
    inputs: std::collections::VecDeque<(Ticks, Input)>,
    ending: Ending,
}

impl Replay {
    /// Reads a file.
    pub fn open(path: &Path) -> Result<Replay, Error> {
        let problem = |what: String| format!("{}: {what}", path.display());
        let length = fs::metadata(path).map_err(|error| problem(error.to_string()))?;
        if length.len() > FILE_LIMIT {
            return Err(problem("too long for a recorded run".into()).into());
        }
        let text = fs::read_to_string(path).map_err(|error| problem(error.to_string()))?;
        Replay::parse(&text, path).map_err(|what| problem(what).into())
    }

    fn parse(text: &str, path: &Path) -> Result<Replay, String> {
        let mut lines = text.lines().enumerate();
        if lines.next().map(|(_, line)| line) != Some(TITLE) {
            return Err(format!(
                "not a recorded run: the first line is not {TITLE:?}"
            ));
        }
        let mut header = |name: &str| {
            let (_, line) = lines.next().ok_or_else(|| cut().to_owned())?;
            let value = line
                .strip_prefix(name)
                .and_then(|rest| rest.strip_prefix(' '));
            value.ok_or_else(|| format!("a line with {name} belongs in the place of {line:?}"))
        };
        let image = hash(header("image")?)?;
        let motion = header("motion")?;
        let (motion, description) = motion.split_once(' ').unwrap_or((motion, ""));
        let origin = Origin {
            image,
            motion: (hash(motion)?, description.to_owned()),
            board: hash(header("board")?)?,
        };
        let mut inputs = std::collections::VecDeque::new();
        for (index, line) in lines {
            let wrong = |what: &str| format!("line {}: {what}", index + 1);
            let words: Vec<&str> = line.split(' ').collect();
            if let ["end", at, "state", state, "stream", bytes, stream] = words[..] {
                let number = |text: &str| text.parse().map_err(|_| wrong("not a number"));
                let ending = Ending {
                    at: number(at)?,
                    state: hash(state)?,
                    bytes: number(bytes)?,
                    stream: hash(stream)?,
                };
                return Ok(Replay {
                    path: path.to_owned(),
                    origin,
                    inputs,
                    ending,
                });
            }
            let (at, input) = line
                .strip_prefix("at ")
                .and_then(|rest| rest.split_once(' '))
                .ok_or_else(|| wrong("neither an input (`at`) nor the end"))?;
            let at = at.parse().map_err(|_| wrong("the time is not a number"))?;
            let input = input.parse::<Input>().map_err(|what| wrong(&what))?;
            inputs.push_back((at, input));
        }
        Err(cut().to_owned())
    }

    /// When it ends.
    pub fn end(&self) -> Ticks {
        self.ending.at
    }

    /// Whether the board at power-on is the one of the recording.
    pub fn check(&self, origin: &Origin) -> Result<(), Error> {
        let path = self.path.display();
        if origin.image != self.origin.image {
            return Err(format!(
                "{path} was recorded with another image (hash {:016x}, here {:016x}); give that one with --image",
                self.origin.image, origin.image
            )
            .into());
        }
        if origin.motion.0 != self.origin.motion.0 {
            return Err(format!(
                "{path} was recorded with another motion ({}); give that one with --motion and --start",
                self.origin.motion.1
            )
            .into());
        }
        if origin.board != self.origin.board {
            return Err(format!(
                "{path} was recorded with other options for the sensor or the processor's pace; give the same"
            )
            .into());
        }
        Ok(())
    }

    /// Takes the inputs that are due.
    pub fn due(&mut self, now: Ticks) -> Vec<Input> {
        let mut due = Vec::new();
        while let Some((_, input)) = self.inputs.pop_front_if(|(at, _)| *at <= now) {
            due.push(input);
        }
        due
    }

    /// Whether the run has ended as recorded.
    pub fn compare(&self, ending: Ending) -> Result<(), Error> {
        if ending == self.ending {
            return Ok(());
        }
        Err(format!(
            "the replay went another way than {}:\nrecorded  {}\nreplayed  {ending}",
            self.path.display(),
            self.ending
        )
        .into())
    }
}

fn cut() -> &'static str {
    "the file ends before the run does: the recording was cut short"
}

fn hash(text: &str) -> Result<u64, String> {
    u64::from_str_radix(text, 16).map_err(|_| format!("{text:?} is not a hash"))
}
