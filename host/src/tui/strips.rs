//! The angles of the last seconds.

use std::collections::VecDeque;

use vrduino::orientation::euler::EulerAngles;

use crate::stream::Sample;

/// What is kept (s).
pub const SPAN: f64 = 10.0;

/// Between two points (s): no terminal tells more apart.
const STEP: f64 = 0.02;

/// What a silence or a new start takes on the strip (s).
const GAP: f64 = 0.5;

/// Names of the angles, in their order.
pub const NAMES: [&str; 3] = ["yaw", "pitch", "roll"];

/// At one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// On a clock of the strips' own, which never goes back (s).
    pub time: f64,
    /// Yaw, pitch and roll (°), as the course notes define them.
    pub angles: [f64; 3],
    /// Whether nothing is missing between the one before and this.
    pub is_joined: bool,
}

/// Three strips of paper that move to the left.
#[derive(Clone, Debug, Default)]
pub struct Strips {
    points: VecDeque<Point>,
    /// When the latest came, on the source's clock.
    arrival: f64,
}

impl Strips {
    /// Takes an orientation, if the one before is not too near.
    pub fn take(&mut self, sample: &Sample) {
        let (before, since) = match self.points.back() {
            Some(point) => (point.time, sample.arrival - self.arrival),
            None => (0.0, f64::INFINITY),
        };
        // The source's clock begins anew with the source.
        let breaks = sample.is_first || !(0.0..GAP).contains(&since);
        if !breaks && since < STEP {
            return;
        }
        let time = before + if breaks { GAP } else { since };
        self.arrival = sample.arrival;
        self.points.push_back(Point {
            time,
            angles: angles(sample),
            is_joined: !breaks,
        });
        while self
            .points
            .front()
            .is_some_and(|point| point.time < time - SPAN)
        {
            self.points.pop_front();
        }
    }

    /// The points, the oldest first.
    pub fn points(&self) -> impl DoubleEndedIterator<Item = &Point> + Clone {
        self.points.iter()
    }

    /// The moment of the latest.
    pub fn now(&self) -> f64 {
        self.points.back().map_or(0.0, |point| point.time)
    }

    /// Least and greatest of an angle, with room about them.
    pub fn range(&self, axis: usize) -> [f64; 2] {
        /// Less is not worth the whole height (°).
        const LEAST: f64 = 20.0;
        let angles = self.points.iter().map(|point| point.angles[axis]);
        let [low, high] = angles.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], angle| {
            [low.min(angle), high.max(angle)]
        });
        if low > high {
            return [-LEAST / 2.0, LEAST / 2.0];
        }
        let half = ((high - low) * 0.55).max(LEAST / 2.0);
        let middle = (high + low) / 2.0;
        // To whole tens, so that the strip does not breathe.
        let tens = |angle: f64, round: fn(f64) -> f64| round(angle / 10.0) * 10.0;
        [
            tens(middle - half, f64::floor),
            tens(middle + half, f64::ceil),
        ]
    }
}

/// Yaw, pitch and roll (°).
pub fn angles(sample: &Sample) -> [f64; 3] {
    let angles = EulerAngles::of(sample.orientation);
    [angles.yaw, angles.pitch, angles.roll].map(|angle| angle.degrees())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    fn sample(arrival: f64, yaw: f64, is_first: bool) -> Sample {
        Sample {
            time: arrival,
            arrival,
            orientation: UnitQuaternion::from_euler_angles(0.0, yaw.to_radians(), 0.0),
            sequence: None,
            status: None,
            delay: None,
            is_first,
        }
    }

    #[test]
    fn a_strip_holds_its_span_and_breaks_where_the_clock_does() {
        let mut strips = Strips::default();
        for i in 0..20_000 {
            strips.take(&sample(f64::from(i) * 1e-3, 27.0, i == 0));
        }
        let span = strips.now() - strips.points().next().expect("there are some").time;
        assert!((SPAN - 0.1..=SPAN).contains(&span), "{span}");
        assert!(strips.points().count() <= 501);
        assert!((strips.points().last().expect("some").angles[0] - 27.0).abs() < 1e-9);
        assert_eq!(strips.range(0), [10.0, 40.0]);
        let before = strips.now();
        strips.take(&sample(0.0, 0.0, true));
        assert!(strips.now() > before);
        assert!(!strips.points().last().expect("some").is_joined);
    }
}
