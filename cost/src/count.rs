//! Runs a filter on the emulated chip.

use std::error::Error;
use std::path::Path;

use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::cpu::timing::Cycles;
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::time::{MILLISECOND, SECOND};

use crate::CORE_MHZ;
use crate::reference::{Orientation, degrees_apart};
use crate::subject::Subject;

/// From one orientation that the program keeps to the next, in samples.
const KEPT_EVERY: usize = 8;

/// The longest a program may take, on its own clock: no filter takes a millisecond a sample for more than ten of them.
const LIMIT: u64 = 10 * SECOND;

/// What `STATE` says in the program while a filter can be run, and when it has been.
const READY: u32 = 1;
const ENDED: u32 = 2;

/// What the updates of a filter cost: all but the first.
#[derive(Debug, Clone, PartialEq)]
pub struct Count {
    /// How many there were.
    pub updates: u64,
    /// Instructions of all.
    pub instructions: u64,
    /// Instructions of the most expensive.
    pub most: u64,
    /// Cycles of all, by both ends of the band.
    pub cycles: Cycles,
    /// As of samples 8, 16, 24 and so on.
    pub orientations: Vec<Orientation>,
}

impl Count {
    /// Instructions an update.
    pub fn mean(&self) -> f64 {
        self.instructions as f64 / self.updates as f64
    }

    /// Cycles an update, by both ends of the band.
    pub fn mean_cycles(&self) -> [f64; 2] {
        [self.cycles.least, self.cycles.greatest].map(|cycles| cycles as f64 / self.updates as f64)
    }

    /// Microseconds an update, by both ends of the band.
    pub fn mean_us(&self) -> [f64; 2] {
        self.mean_cycles().map(|cycles| cycles / CORE_MHZ)
    }

    /// The largest angle to the orientations of `reference`, which has one for each sample, in degrees.
    pub fn error(&self, reference: &[Orientation]) -> f64 {
        let kept = reference.iter().skip(KEPT_EVERY - 1).step_by(KEPT_EVERY);
        self.orientations
            .iter()
            .zip(kept)
            .map(|(&ours, &reference)| degrees_apart(ours, reference))
            .fold(0.0, f64::max)
    }
}

/// Counts `subject` in the program at `image`.
///
/// # Errors
///
/// In words, if the program is not one of ours, breaks a rule of the chip or does not come to its end.
pub fn count(image: &Path, subject: &Subject) -> Result<Count, Box<dyn Error>> {
    let mut board = started(image, subject)?;
    until(&mut board, ENDED, subject.name)?;

    let calls = board.measure().calls;
    let address = board
        .image()
        .address_of("run::KEPT")
        .ok_or("the program keeps no orientations; build it again")?;
    let samples = calls.count as usize + 1;
    let bytes = board.peek(address, samples / KEPT_EVERY * 32);
    let double = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().unwrap_or([0; 8]));
    let orientations = bytes
        .chunks_exact(32)
        .map(|bytes| [0, 8, 16, 24].map(|at| double(&bytes[at..at + 8])))
        .collect();
    Ok(Count {
        updates: calls.count,
        instructions: calls.instructions,
        most: calls.most_instructions,
        cycles: calls.cycles,
        orientations,
    })
}

/// Instructions of a sample by the function they are executed in, the most first. What feeds the filter and keeps its
/// orientations is among them.
///
/// # Errors
///
/// As of [`count`].
pub fn profile(image: &Path, subject: &Subject) -> Result<Vec<(String, f64)>, Box<dyn Error>> {
    let mut board = started(image, subject)?;
    board.profile();
    until(&mut board, ENDED, subject.name)?;
    let updates = board.measure().calls.count as f64;
    let mut functions: Vec<_> = board
        .profiled()
        .into_iter()
        .map(|(name, share)| (name, share.instructions as f64 / updates))
        .collect();
    functions.sort_by(|(_, one), (_, other)| other.total_cmp(one));
    Ok(functions)
}

/// A board at the beginning of the filter.
fn started(image: &Path, subject: &Subject) -> Result<Board, Box<dyn Error>> {
    let image = Image::open(image)?;
    let name = subject.name;
    let run = image
        .address_of(&format!("{name}::run"))
        .ok_or_else(|| format!("the program has no filter {name}; build it again"))?;
    // The sensor plays no part.
    let mut setup = Setup::new(Box::new(Turns::new(1e6, 0.0)));
    setup.timed_function = format!("{name}::update");
    let mut board = Board::new(image, setup);
    until(&mut board, READY, name)?;
    board.jump(run);
    Ok(board)
}

/// Runs until the program says `state`.
fn until(board: &mut Board, state: u32, name: &str) -> Result<(), String> {
    let end = board.now() + LIMIT;
    while board.variable("run::STATE") != Some(state) {
        board.run(MILLISECOND);
        if let Some(stop) = board.stop() {
            return Err(format!("{name}: {stop}"));
        }
        if board.now() > end {
            return Err(format!("{name} does not come to its end within 10 s"));
        }
    }
    Ok(())
}
