//! A curve of any length in a bounded number of points, which looks the same.
//!
//! Of every strip of time, no wider than what is drawn as one column, the first, lowest, highest and last
//! points are kept (“M4”: Jugel and others, 2014): a line through them covers what a line through all
//! would. The strips become wider as the curve grows longer.

/// Strips at most; half as many at least, once the curve is long.
const STRIPS: usize = 2400;

/// Of a curve that has just begun (s): no sensor is as fast.
const NARROWEST: f64 = 1e-4;

/// A point: time (s), value.
pub type Point = (f64, f64);

#[derive(Clone, Copy, Debug)]
struct Strip {
    first: Point,
    low: Point,
    high: Point,
    last: Point,
    /// The line is broken before it.
    is_apart: bool,
}

impl Strip {
    fn join(self, later: Self) -> Self {
        let lower = later.low.1 < self.low.1;
        let higher = later.high.1 > self.high.1;
        Self {
            low: if lower { later.low } else { self.low },
            high: if higher { later.high } else { self.high },
            last: later.last,
            ..self
        }
    }
}

/// A curve.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    start: f64,
    width: f64,
    strips: Vec<Option<Strip>>,
    is_broken: bool,
}

impl Curve {
    /// The next point; time does not go back.
    pub fn push(&mut self, point: Point) {
        if self.strips.is_empty() {
            self.start = point.0;
            self.width = NARROWEST;
        }
        let mut place = self.place(point.0);
        while place >= STRIPS {
            self.widen();
            place = self.place(point.0);
        }
        if self.strips.len() <= place {
            self.strips.resize(place + 1, None);
        }
        let strip = Strip {
            first: point,
            low: point,
            high: point,
            last: point,
            is_apart: std::mem::take(&mut self.is_broken),
        };
        let joined = self.strips[place].map_or(strip, |before| before.join(strip));
        self.strips[place] = Some(joined);
    }

    /// No line is drawn to the next point.
    pub fn interrupt(&mut self) {
        self.is_broken = true;
    }

    fn place(&self, time: f64) -> usize {
        ((time - self.start) / self.width) as usize
    }

    fn widen(&mut self) {
        self.width *= 2.0;
        self.strips = self
            .strips
            .chunks(2)
            .map(|pair| match *pair {
                [Some(earlier), Some(later)] => Some(earlier.join(later)),
                [earlier, later] => earlier.or(later),
                [last] => last,
                _ => None,
            })
            .collect();
    }

    /// The lines it is drawn by; one of a single point is a dot.
    pub fn lines(&self) -> Vec<Vec<Point>> {
        let mut lines: Vec<Vec<Point>> = Vec::new();
        for strip in self.strips.iter().flatten() {
            let (early, late) = match strip.low.0 <= strip.high.0 {
                true => (strip.low, strip.high),
                false => (strip.high, strip.low),
            };
            let mut points = vec![strip.first, early, late, strip.last];
            points.dedup();
            match lines.last_mut() {
                Some(line) if !strip.is_apart => line.append(&mut points),
                _ => lines.push(points),
            }
        }
        lines
    }

    /// The least and the greatest value.
    pub fn range(&self) -> Option<(f64, f64)> {
        let strips = self.strips.iter().flatten();
        strips.fold(None, |range, strip| {
            let (low, high) = range.unwrap_or((f64::INFINITY, f64::NEG_INFINITY));
            Some((low.min(strip.low.1), high.max(strip.high.1)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Curve, STRIPS};

    #[test]
    fn a_long_curve_keeps_its_peaks_its_ends_and_its_gaps() {
        let mut curve = Curve::default();
        for tick in 0..3_600_000_u32 {
            if tick == 1_800_000 {
                curve.interrupt();
            }
            let (gap, peak) = (
                if tick < 1_800_000 { 0.0 } else { 60.0 },
                if tick == 1_234_567 { 50.0 } else { 0.0 },
            );
            let time = f64::from(tick) * 1e-3;
            curve.push((time + gap, time.sin() + peak));
        }
        let (low, high) = curve.range().expect("points");
        assert!((low + 1.0).abs() < 1e-3, "{low}");
        assert!(high > 49.0, "{high}");
        let lines = curve.lines();
        assert_eq!(lines.len(), 2);
        assert_eq!(lines[0][0], (0.0, 0.0));
        let (end, _) = *lines[1].last().expect("its end");
        assert!((end - 3659.999).abs() < 1e-9, "{end}");
        let points: usize = lines.iter().map(Vec::len).sum();
        assert!((STRIPS..=4 * STRIPS).contains(&points), "{points}");
        assert!(
            lines
                .iter()
                .all(|line| line.is_sorted_by_key(|point| point.0))
        );
    }

    #[test]
    fn times_far_apart_are_one_curve() {
        let mut curve = Curve::default();
        curve.push((-1e9, 1.0));
        curve.push((1e9, 2.0));
        assert_eq!(curve.lines(), [[(-1e9, 1.0), (1e9, 2.0)]]);
    }
}
