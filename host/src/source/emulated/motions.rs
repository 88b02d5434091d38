//! What the emulated sensor can be carried through.

use std::path::Path;
use std::sync::Arc;

use vrduino_emulator::motion::{self, Instant, Motion, Turns};

use super::hand::Hand;
use crate::failure::{Failure, Kind};

/// Those that have a name, the usual one first.
pub const NAMES: [&str; 4] = ["head", "turns", "hand", "still"];

/// Long enough for the gyro's bias to be measured.
const STILL: f64 = 3.0;

/// The motion of this name, or in this file; `hand` is the one to turn it by.
pub fn open(name: &str, hand: &Hand) -> Result<Box<dyn Motion>, Failure> {
    Ok(match name {
        "head" => motion::built_in(),
        "turns" => Box::new(quarter_turns()),
        "hand" => Box::new(hand.clone()),
        "still" => Box::new(Turns::new(STILL, 0.0)),
        path if Path::new(path).exists() => motion::open(Path::new(path))
            .map_err(|error| Failure::new(Kind::File, error.to_string()))?,
        other => {
            let sentence = format!(
                "there is no motion and no file called {other}: take {}, or the path of a recording",
                NAMES.join(", ")
            );
            return Err(Failure::new(Kind::File, sentence));
        }
    })
}

/// To the left, up, to the side, and each time back again, for an hour.
fn quarter_turns() -> Turns {
    const AXES: [[f64; 3]; 3] = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    const ROUNDS: usize = 400;
    let steps = (0..ROUNDS)
        .flat_map(|_| AXES)
        .flat_map(|axis| [(axis, 90.0), (axis, -90.0)]);
    steps.fold(Turns::new(STILL, 0.5), |turns, (axis, degrees)| {
        turns.turn(axis, degrees, 1.0)
    })
}

/// A motion that somebody else looks at as well.
pub struct Shared(pub Arc<dyn Motion>);

impl Motion for Shared {
    fn at(&self, t: f64) -> Instant {
        self.0.at(t)
    }

    fn duration(&self) -> Option<f64> {
        self.0.duration()
    }

    fn describe(&self) -> String {
        self.0.describe()
    }
}
