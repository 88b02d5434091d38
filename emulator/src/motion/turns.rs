//! A scripted motion for tests: still, then one turn after another.

use std::f64::consts::TAU;

use super::rotation::{IDENTITY, about, gravity_in_body, multiply, normalized};
use super::{Instant, Motion};

/// Turns about fixed axes, each starting and stopping softly, with rests between them.
///
/// Only gravity acts besides the turning, and the truth is exact, so a test can say beforehand where
/// the sensor ends up.
///
/// ```
/// use vrduino_emulator::motion::{Motion, Turns};
///
/// // Two seconds of rest, then a quarter turn to the left in half a second.
/// let turns = Turns::new(2.0, 0.5).turn([0.0, 1.0, 0.0], 90.0, 0.5);
/// let [w, _, y, _] = turns.at(10.0).truth.unwrap();
/// assert!((w - y).abs() < 1e-12);
/// ```
#[derive(Debug, Clone)]
pub struct Turns {
    pause: f64,
    start: [f64; 4],
    turns: Vec<Turn>,
    end: f64,
}

#[derive(Debug, Clone, Copy)]
struct Turn {
    begin: f64,
    axis: [f64; 3],
    angle: f64,
    seconds: f64,
}

impl Turns {
    /// Level and still for `still` seconds. `pause` is the rest after each turn (s).
    ///
    /// # Panics
    ///
    /// If one of them is negative or not finite: a mistake in the script.
    pub fn new(still: f64, pause: f64) -> Self {
        assert!(still.is_finite() && still >= 0.0, "still for {still} s");
        assert!(pause.is_finite() && pause >= 0.0, "a pause of {pause} s");
        Self {
            pause,
            start: IDENTITY,
            turns: Vec::new(),
            end: still,
        }
    }

    /// Begins in this attitude body → world (y up) instead of level.
    ///
    /// # Panics
    ///
    /// If it is not a rotation: a mistake in the script.
    pub fn from_attitude(self, body_to_world: [f64; 4]) -> Self {
        let start = normalized(body_to_world).expect("an attitude is a unit quaternion");
        Self { start, ..self }
    }

    /// Then stays as it is for `seconds`, besides the pauses.
    ///
    /// # Panics
    ///
    /// If that is negative or not finite: a mistake in the script.
    pub fn rest(mut self, seconds: f64) -> Self {
        assert!(
            seconds.is_finite() && seconds >= 0.0,
            "a rest of {seconds} s"
        );
        self.end += seconds;
        self
    }

    /// Then turns by `degrees` about `axis` (body frame, any length), right-handed, in `seconds`.
    ///
    /// # Panics
    ///
    /// If the axis has no direction or the time is not positive: a mistake in the script.
    pub fn turn(mut self, axis: [f64; 3], degrees: f64, seconds: f64) -> Self {
        let length = axis.iter().map(|c| c * c).sum::<f64>().sqrt();
        assert!(length.is_finite() && length > 0.0, "an axis {axis:?}");
        assert!(degrees.is_finite(), "a turn by {degrees}°");
        assert!(
            seconds.is_finite() && seconds > 0.0,
            "a turn in {seconds} s"
        );
        self.turns.push(Turn {
            begin: self.end,
            axis: axis.map(|c| c / length),
            angle: degrees.to_radians(),
            seconds,
        });
        self.end += seconds + self.pause;
        self
    }
}

impl Turn {
    /// The part of the turn done `t` seconds into the motion (rad), and its rate (rad/s).
    ///
    /// The rate is a raised cosine, A/T (1 − cos 2πs): zero at both ends, and so is its slope.
    fn progress(&self, t: f64) -> (f64, f64) {
        let s = ((t - self.begin) / self.seconds).clamp(0.0, 1.0);
        let (sin, cos) = (TAU * s).sin_cos();
        (
            self.angle * (s - sin / TAU),
            self.angle / self.seconds * (1.0 - cos),
        )
    }
}

impl Motion for Turns {
    fn at(&self, t: f64) -> Instant {
        let mut attitude = self.start;
        let mut rate = [0.0; 3];
        for turn in self.turns.iter().take_while(|turn| turn.begin < t) {
            let (angle, speed) = turn.progress(t);
            attitude = multiply(attitude, about(turn.axis, angle));
            rate = turn.axis.map(|c| c * speed);
        }
        Instant {
            rate,
            force: gravity_in_body(attitude),
            field: None,
            truth: Some(attitude),
        }
    }

    fn duration(&self) -> Option<f64> {
        Some(self.end)
    }

    fn describe(&self) -> String {
        format!("{} scripted turns in {:.1} s", self.turns.len(), self.end)
    }
}
