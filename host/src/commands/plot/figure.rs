//! What there is to be drawn of a recording, in bounded space however long it is.

use std::path::Path;

use vrduino::orientation::euler::EulerAngles;
use vrduino::orientation::flatland::shortest_turn;
use vrduino::units::Angle;

use super::curve::{Curve, Point};
use super::gaps::Gaps;
use super::rate::Rate;
use crate::failure::{Failure, Kind};
use crate::recording::{Entry, Head, Reader};
use crate::stream::Sample;

/// A step so many times as long as usual is a gap, where there are no numbers to tell.
const MUCH_LONGER: f64 = 5.0;

/// And so long (s): the host may have been busy.
const NOTICEABLE: f64 = 0.1;

/// What there is to be drawn. Times in s from the first sample.
#[derive(Clone, Debug)]
pub struct Figure {
    /// What it is of.
    pub title: String,
    /// More about it.
    pub subtitle: String,
    /// In degrees; it goes on beyond 180.
    pub yaw: Curve,
    /// In degrees.
    pub pitch: Curve,
    /// In degrees.
    pub roll: Curve,
    /// Samples a second.
    pub rate: Vec<Point>,
    /// In ms, as far as it is known.
    pub delay: Curve,
    /// Where samples are missing.
    pub gaps: Vec<(f64, f64)>,
    /// Where the board or the connection began anew.
    pub restarts: Vec<f64>,
    /// The last sample.
    pub end: f64,
}

impl Figure {
    /// Of a recording.
    pub fn of(path: &Path, reader: &mut Reader) -> Result<Self, Failure> {
        let mut survey = Survey::default();
        while let Some(entry) = reader.read()? {
            if let Entry::Row(row) = entry {
                survey.take(&row.sample);
            }
        }
        if survey.samples == 0 {
            let sentence = format!(
                "{} holds no sample: there is nothing to draw",
                path.display()
            );
            return Err(Failure::new(Kind::File, sentence));
        }
        let name = path.file_name().unwrap_or(path.as_os_str());
        let cut = if reader.ending().is_cut {
            ", cut off"
        } else {
            ""
        };
        Ok(Self {
            title: title(&name.to_string_lossy(), reader.head()),
            subtitle: survey.describe() + cut,
            yaw: survey.yaw,
            pitch: survey.pitch,
            roll: survey.roll,
            rate: survey.rate.points(),
            delay: survey.delay,
            gaps: survey.gaps.bands().to_vec(),
            restarts: survey.restarts,
            end: survey.now,
        })
    }
}

/// As `desk.csv: vrduino 0.1.0 on /dev/ttyACM0, 2026-11-22 16:41`.
fn title(name: &str, head: &Head) -> String {
    let board = head.board.as_deref().unwrap_or("stream");
    let mut title = format!("{name}: {board}");
    if !head.source.is_empty() {
        title += &format!(" on {}", head.source);
    }
    // To the minute.
    if let Some(started) = head.started.get(..16) {
        title += &format!(", {}", started.replace('T', " "));
    }
    title
}

#[derive(Debug, Default)]
struct Survey {
    yaw: Curve,
    pitch: Curve,
    roll: Curve,
    rate: Rate,
    delay: Curve,
    gaps: Gaps,
    restarts: Vec<f64>,
    samples: u64,
    missing: u64,
    /// Of the figure, where the latest sample stands.
    now: f64,
    /// What is to be added to a sample's time.
    offset: f64,
    latest: Option<Sample>,
    yaw_before: Option<Angle<f64>>,
    /// The usual step from sample to sample (s), once there was one.
    step: Option<f64>,
}

impl Survey {
    fn take(&mut self, sample: &Sample) {
        if let Some(before) = self.latest.replace(*sample) {
            self.go_on(&before, sample);
        } else {
            self.offset = -sample.time;
        }
        let angles = EulerAngles::of(sample.orientation);
        let before = self.yaw_before.unwrap_or(angles.yaw);
        let yaw = Angle::from_rad(before.rad() + shortest_turn(before, angles.yaw).rad());
        self.yaw_before = Some(yaw);
        self.samples += 1;
        self.rate.count(self.now);
        self.yaw.push((self.now, yaw.degrees()));
        self.pitch.push((self.now, angles.pitch.degrees()));
        self.roll.push((self.now, angles.roll.degrees()));
        if let Some(delay) = sample.delay {
            self.delay.push((self.now, delay * 1e3));
        }
    }

    fn go_on(&mut self, before: &Sample, sample: &Sample) {
        let from = self.now;
        if sample.is_first {
            // Its clock tells nothing about the time before; the computer's does, unless it began anew too.
            let pause = (sample.arrival - before.arrival).max(0.0);
            self.offset = from + pause - sample.time;
            self.restarts.push(from + pause);
        }
        self.now = from.max(sample.time + self.offset);
        let step = self.now - from;
        let missing = match (before.sequence, sample.sequence) {
            _ if sample.is_first => 0,
            (Some(before), Some(now)) => now.wrapping_sub(before).wrapping_sub(1),
            _ => 0,
        };
        self.missing += u64::from(missing);
        let usual = self.step.unwrap_or(step);
        let is_long = step > NOTICEABLE.max(MUCH_LONGER * usual);
        if missing > 0 || is_long {
            self.gaps.push(from, self.now);
        }
        if missing > 0 || is_long || sample.is_first {
            for curve in [
                &mut self.yaw,
                &mut self.pitch,
                &mut self.roll,
                &mut self.delay,
            ] {
                curve.interrupt();
            }
        } else {
            self.step = Some(usual + (step - usual) / 64.0);
        }
    }

    fn describe(&self) -> String {
        let several = if self.samples == 1 { "" } else { "s" };
        let mut text = format!("{} sample{several} in {:.1} s", self.samples, self.now);
        let parts = [
            (self.missing, "missing", "missing"),
            (self.gaps.count(), "gap", "gaps"),
            (
                self.restarts.len() as u64,
                "new beginning",
                "new beginnings",
            ),
        ];
        for (count, one, several) in parts {
            match count {
                0 => {}
                1 => text += &format!(", 1 {one}"),
                count => text += &format!(", {count} {several}"),
            }
        }
        text
    }
}
