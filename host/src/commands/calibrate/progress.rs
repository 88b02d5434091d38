//! How far each of the three parts has got, shown while it goes on.

use indicatif::{ProgressBar, ProgressStyle};
use vrduino::calibration::ellipsoid;
use vrduino::calibration::six_positions::Step;
use vrduino::wire::frame::Counts;

use super::map::Map;
use super::procedure::Procedure;
use crate::output::Output;

/// A map that is good enough and has not grown for so long (s) is as full as it will be.
const GROWN: f64 = 8.0;

/// Of all directions: more is not worth a search.
const ENOUGH: f32 = 0.95;

/// Between two looks at how far it has got, in s on the board's clock.
const LOOK: f64 = 0.25;

/// One of the three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// It lies still, for the gyro.
    Still,
    /// It lies on its faces, for the accelerometer.
    Faces,
    /// It is turned, for the magnetometer.
    Turning,
}

impl Part {
    /// In their order.
    pub const ALL: [Self; 3] = [Self::Still, Self::Faces, Self::Turning];

    /// What the user is asked to do.
    pub fn request(self) -> &'static str {
        match self {
            Self::Still => "1 of 3  Lay the board down and take the hand away.",
            Self::Faces => {
                "2 of 3  Lay it on each of its six faces in any order, two seconds each: against a box, if it does not stand."
            }
            Self::Turning => {
                "3 of 3  Take it away from iron and turn it slowly every way until the map is full."
            }
        }
    }
}

/// How far a part has got.
pub struct Progress {
    part: Part,
    /// Drawn on a terminal only.
    bar: ProgressBar,
    /// The board's clock (s): when it began, now, and when it was looked at.
    began: Option<f64>,
    now: f64,
    looked: f64,
    /// How full the map is, and when it last grew.
    share: f32,
    grew: f64,
}

impl Progress {
    /// At its beginning.
    pub fn new(part: Part) -> Self {
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{msg}") {
            bar.set_style(style);
        }
        Self {
            part,
            bar,
            began: None,
            now: 0.0,
            looked: 0.0,
            share: 0.0,
            grew: 0.0,
        }
    }

    /// Removes what is drawn.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }

    /// The board's clock goes on (s), or begins anew.
    pub fn pass(&mut self, time: f64, is_first: bool) {
        if self.began.is_none() || is_first {
            self.began = Some(time);
            self.looked = time;
            self.grew = time;
        }
        self.now = time;
    }

    /// Takes what the registers held.
    pub fn take(&mut self, counts: &Counts, procedure: &mut Procedure, output: &mut Output) {
        if self.part == Part::Turning {
            procedure.turn(counts);
            return;
        }
        match procedure.rest(&counts.sample) {
            Some(Step::Taken { face, windows })
                if self.part == Part::Faces && windows == Procedure::seconds_on_a_face() =>
            {
                self.say(output, &format!("        {face}: done"));
            }
            Some(Step::Tilted { nearest, tilt }) => {
                let degrees = tilt.degrees();
                self.say(
                    output,
                    &format!("        {degrees:.0}° from {nearest}: hold it straighter"),
                );
            }
            Some(Step::NotGravity) => {
                self.say(
                    output,
                    "        it feels something else than gravity: lay it on a table",
                );
            }
            Some(Step::Taken { .. } | Step::Moved) | None => {}
        }
    }

    /// Above what is drawn.
    fn say(&self, output: &mut Output, line: &str) {
        self.bar.suspend(|| output.say(line));
    }

    /// Whether there is nothing left to wait for, or no time, looked at now and then.
    pub fn is_over(&mut self, procedure: &Procedure, seconds: f64) -> bool {
        let Some(began) = self.began else {
            return false;
        };
        if self.now - self.looked < LOOK {
            return false;
        }
        self.looked = self.now;
        let done = match self.part {
            Part::Still => procedure.gyro().is_some(),
            Part::Faces => procedure.missing().is_empty(),
            Part::Turning => self.is_full(procedure),
        };
        self.draw(procedure);
        done || self.now - began > seconds
    }

    fn is_full(&mut self, procedure: &Procedure) -> bool {
        let found = procedure.magnetometer();
        let share = match &found {
            Ok(found) => found.coverage,
            Err(ellipsoid::Refusal::Coverage(coverage)) => coverage.share,
            Err(_) => 0.0,
        };
        if share > self.share {
            self.share = share;
            self.grew = self.now;
        }
        found.is_ok() && (share >= ENOUGH || self.now - self.grew > GROWN)
    }

    fn draw(&mut self, procedure: &Procedure) {
        if self.bar.is_hidden() {
            return;
        }
        let mut lines = vec![format!("        {}", self.state(procedure))];
        if self.part == Part::Turning {
            // Around the board's y: a column is an angle, and these axes lie in the middle row.
            lines.push("         -z          -x          z           x           -z".into());
            let rows = Map::so_far(procedure).lines();
            let last = rows.len() - 1;
            lines.extend(rows.iter().enumerate().map(|(number, row)| {
                let axis = match number {
                    0 => " y",
                    _ if number == last => "-y",
                    _ => "  ",
                };
                format!("     {axis}  {row}")
            }));
        }
        self.bar.set_message(lines.join("\n"));
        self.bar.tick();
    }

    /// How far it is, in a line.
    pub fn state(&self, procedure: &Procedure) -> String {
        match self.part {
            Part::Still => match procedure.gyro() {
                Some(_) => "still".into(),
                None => "not still yet".into(),
            },
            Part::Faces => {
                let missing = procedure.missing();
                if missing.is_empty() {
                    "all six faces".into()
                } else {
                    format!("missing: {missing}")
                }
            }
            Part::Turning => match procedure.magnetometer() {
                Ok(found) => format!(
                    "{:.0} % of all directions, largest hole {:.0}°",
                    100.0 * found.coverage,
                    found.largest_hole.degrees()
                ),
                Err(refusal) => refusal.to_string(),
            },
        }
    }
}
