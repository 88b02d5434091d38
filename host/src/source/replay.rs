//! A recording, played as it came.

use std::path::PathBuf;

use super::{Event, Gone, Listener};
use crate::failure::{Failure, Kind};

/// Which recording, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// The file.
    pub path: PathBuf,
}

/// Plays it.
pub(super) fn run(replay: &Replay, listener: &mut Listener) -> Result<(), Gone> {
    let sentence = format!("{} cannot be played", replay.path.display());
    listener.tell(Event::Ended(Err(Failure::new(Kind::File, sentence))))
}
