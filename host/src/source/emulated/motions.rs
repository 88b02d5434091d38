//! What the emulated sensor can be carried through.

use std::path::Path;
use std::sync::Arc;

use vrduino_emulator::motion::{self, Instant, Motion, Turns};

use super::hand::Hand;
use crate::failure::{Failure, Kind};

/// Those that have a name, the usual one first.
pub const NAMES: [&str; 5] = ["head", "turns", "hand", "still", "tumble"];

/// Long enough for the gyro's bias to be measured.
const STILL: f64 = 3.0;

/// The motion of this name, or in this file; `hand` is the one to turn it by.
pub fn open(name: &str, hand: &Hand) -> Result<Box<dyn Motion>, Failure> {
    Ok(match name {
        "head" => motion::built_in(),
        "turns" => Box::new(quarter_turns()),
        "hand" => Box::new(hand.clone()),
        "tumble" => Box::new(tumble()),
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

/// As a board is calibrated, again and again for an hour: laid on each of its faces, then turned about one
/// axis while that tips over slowly, until every direction has come from everywhere.
fn tumble() -> Turns {
    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    const ROUNDS: usize = 110;
    /// Two seconds are wanted on each face; and some to see that it lies.
    const REST: f64 = 2.3;
    /// Which axis, how far, and whether it is a face on which it has not lain yet.
    const FACES: [([f64; 3], f64, bool); 7] = [
        (Z, 90.0, true),
        (Z, 90.0, true),
        (Z, 90.0, true),
        (Z, 90.0, false),
        (X, 90.0, true),
        (X, 180.0, true),
        (X, 90.0, false),
    ];
    const TIPS: u32 = 8;
    (0..ROUNDS).fold(Turns::new(STILL, 0.0), |turns, _| {
        let turns = FACES
            .into_iter()
            .fold(turns.rest(REST), |turns, (axis, degrees, new)| {
                let turns = turns.turn(axis, degrees, 0.8);
                turns.rest(if new { REST } else { 0.0 })
            });
        let turns = (0..TIPS).fold(turns, |turns, _| {
            let tip = 180.0 / f64::from(TIPS);
            turns.turn(Z, 360.0, 1.0).turn(X, tip, 0.2)
        });
        turns.turn(X, 180.0, 1.0)
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
