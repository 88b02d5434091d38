//! How many samples a second there were, over time.

use super::curve::Point;

/// Strips of time at most.
const STRIPS: usize = 480;

/// Of a recording that has just begun (s).
const NARROWEST: f64 = 1.0 / 64.0;

/// Samples of which a rate can be told.
const ENOUGH: u64 = 8;

#[derive(Clone, Copy, Debug, Default)]
struct Strip {
    count: u64,
    first: f64,
    last: f64,
}

impl Strip {
    fn join(self, later: Self) -> Self {
        match (self.count, later.count) {
            (0, _) => later,
            (_, 0) => self,
            _ => Self {
                count: self.count + later.count,
                first: self.first,
                last: later.last,
            },
        }
    }
}

/// Counts samples.
#[derive(Clone, Debug, Default)]
pub struct Rate {
    start: f64,
    width: f64,
    strips: Vec<Strip>,
}

impl Rate {
    /// One came at this time (s), which does not go back.
    pub fn count(&mut self, time: f64) {
        if self.strips.is_empty() {
            self.start = time;
            self.width = NARROWEST;
        }
        let mut place = self.place(time);
        while place >= STRIPS {
            self.widen();
            place = self.place(time);
        }
        if self.strips.len() <= place {
            self.strips.resize(place + 1, Strip::default());
        }
        let one = Strip {
            count: 1,
            first: time,
            last: time,
        };
        self.strips[place] = self.strips[place].join(one);
    }

    fn place(&self, time: f64) -> usize {
        ((time - self.start) / self.width) as usize
    }

    fn widen(&mut self) {
        self.width *= 2.0;
        let join = |pair: &[Strip]| pair.iter().copied().fold(Strip::default(), Strip::join);
        self.strips = self.strips.chunks(2).map(join).collect();
    }

    /// The rate (1/s) in the middle of every strip.
    pub fn points(mut self) -> Vec<Point> {
        let sparse = |strip: &Strip| strip.count > 0 && strip.count < ENOUGH;
        // The last may be short.
        while self.strips.len() > 2 && self.strips[..self.strips.len() - 1].iter().any(sparse) {
            let few = self.strips.iter().filter(|strip| sparse(strip)).count();
            // A strip in which a gap begins or ends has few: they are no reason.
            if few * 4 < self.strips.len() {
                break;
            }
            self.widen();
        }
        let strips = self.strips.iter().enumerate();
        strips
            .filter_map(|(place, strip)| {
                let middle = self.start + (place as f64 + 0.5) * self.width;
                let span = strip.last - strip.first;
                match strip.count {
                    0 => Some((middle, 0.0)),
                    // By the time between its samples, which has no corners that depend on where it is cut.
                    2.. if span > 0.0 => {
                        let time = middle.min(strip.last).max(strip.first);
                        Some((time, (strip.count - 1) as f64 / span))
                    }
                    _ => None,
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Rate;

    #[test]
    fn a_steady_rate_is_steady_and_a_gap_is_none() {
        for period in [1e-3, 1e-2, 1.0] {
            let mut rate = Rate::default();
            let count = if period < 1.0 { 20_000 } else { 300 };
            for tick in 0..count {
                let gap = if tick < count / 2 {
                    0.0
                } else {
                    f64::from(count) * period
                };
                rate.count(f64::from(tick) * period + gap);
            }
            let points = rate.points();
            let near = |rate: f64| (rate * period - 1.0).abs() < 1e-6;
            let steady = points.iter().filter(|point| near(point.1)).count();
            let none = points.iter().filter(|point| point.1 == 0.0).count();
            assert!(steady > 9 && none > 5, "{period}: {steady}, {none}");
            assert!(steady + none + 2 >= points.len(), "{points:?}");
        }
    }
}
