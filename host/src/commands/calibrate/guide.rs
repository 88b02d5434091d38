//! Leads through the three parts, and shows how far each has got.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use vrduino::calibration::ellipsoid;
use vrduino::calibration::six_positions::Step;
use vrduino::wire::frame::Counts;

use super::map::Map;
use super::procedure::Procedure;
use crate::board::Acquaintance;
use crate::failure::{Failure, Kind};
use crate::hub::{State, Update};
use crate::interrupt::Interrupt;
use crate::output::Output;
use crate::stream::Item;

/// How long counts are waited for.
const SILENCE: Duration = Duration::from_secs(3);

/// Between two looks at how far it has got, in s on the board's clock.
const LOOK: f64 = 0.25;

/// Of all directions: more is not worth a search.
const ENOUGH: f32 = 0.95;

/// A map that is good enough and has not grown for so long (s) is as full as it will be.
const GROWN: f64 = 8.0;

/// One of the three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Still,
    Faces,
    Turning,
}

impl Part {
    fn request(self) -> &'static str {
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

/// The map as far as it goes: about the fit's centre, if there is one.
pub fn map(procedure: &Procedure) -> Map {
    let fields = procedure.fields();
    match procedure.magnetometer() {
        Ok(found) => {
            let correct = found.calibration();
            Map::of(fields.iter().map(|&field| {
                let field = vrduino::units::MagneticField::from_microtesla(field);
                correct.corrected(field).microtesla()
            }))
        }
        Err(_) => Map::about_the_middle(fields),
    }
}

/// Leads through it.
pub struct Guide<'a> {
    board: &'a Acquaintance,
    interrupt: &'a Interrupt,
    seconds: f64,
}

impl<'a> Guide<'a> {
    /// With so many seconds at most for each part.
    pub fn new(board: &'a Acquaintance, interrupt: &'a Interrupt, seconds: f64) -> Self {
        Self {
            board,
            interrupt,
            seconds,
        }
    }

    /// Leads through all parts; whether it was let.
    ///
    /// # Errors
    ///
    /// The board goes, or sends no counts.
    pub fn lead(&self, procedure: &mut Procedure, output: &mut Output) -> Result<bool, Failure> {
        for part in [Part::Still, Part::Faces, Part::Turning] {
            if part == Part::Turning && !procedure.has_magnetometer() {
                continue;
            }
            output.say(part.request());
            let mut progress = Progress::new(part);
            let went_on = self.follow(procedure, &mut progress, output);
            progress.bar.finish_and_clear();
            if !went_on? {
                return Ok(false);
            }
            output.say(format!("        {}", progress.state(procedure)));
        }
        Ok(true)
    }

    fn follow(
        &self,
        procedure: &mut Procedure,
        progress: &mut Progress,
        output: &mut Output,
    ) -> Result<bool, Failure> {
        let mut heard = Instant::now();
        loop {
            if self.interrupt.has_come() || output.is_closed() {
                return Ok(false);
            }
            match self.board.updates.next(Duration::from_millis(100)) {
                Some(Update::Stream(items)) => {
                    for item in items.iter() {
                        match item {
                            Item::Sample(sample) => progress.pass(sample.time, sample.is_first),
                            Item::Registers(registers) => {
                                heard = Instant::now();
                                progress.take(&registers.counts, procedure, output);
                            }
                            Item::Line(line) if line.starts_with("error") => {
                                return Err(Failure::new(
                                    Kind::Stream,
                                    format!(
                                        "the board says `{line}`; `vrduino doctor` looks closer"
                                    ),
                                ));
                            }
                            Item::Line(_) => {}
                        }
                        if progress.is_over(procedure, self.seconds) {
                            return Ok(true);
                        }
                    }
                }
                Some(Update::Status(status)) => {
                    if let (Some(failure), State::Lost | State::Ended) =
                        (&status.trouble, status.state)
                    {
                        let sentence = format!("{failure}; nothing was kept, run this again");
                        return Err(Failure::new(failure.kind, sentence));
                    }
                }
                Some(Update::Bytes(_) | Update::Truth(_)) => {}
                Some(Update::Ended(Err(failure))) => return Err(failure),
                Some(Update::Ended(Ok(()))) | None => {}
            }
            if heard.elapsed() > SILENCE {
                return Err(Failure::new(
                    Kind::Stream,
                    "the board sends no counts: its sensor may have stopped (`vrduino doctor` looks closer)",
                ));
            }
        }
    }
}

/// How far a part has got.
struct Progress {
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
    fn new(part: Part) -> Self {
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

    fn pass(&mut self, time: f64, is_first: bool) {
        if self.began.is_none() || is_first {
            self.began = Some(time);
            self.looked = time;
            self.grew = time;
        }
        self.now = time;
    }

    fn take(&mut self, counts: &Counts, procedure: &mut Procedure, output: &mut Output) {
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

    /// Whether there is nothing left to wait for, looked at now and then.
    fn is_over(&mut self, procedure: &Procedure, seconds: f64) -> bool {
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
            let rows = map(procedure).lines();
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

    /// In a line.
    fn state(&self, procedure: &Procedure) -> String {
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
