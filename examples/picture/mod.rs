//! Lines over an axis, as an SVG file: all that the examples draw.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// A line with its name.
pub struct Line<'a> {
    /// As the legend has it.
    pub name: &'a str,
    /// Its points; a point that is not finite interrupts the line.
    pub points: Vec<[f64; 2]>,
}

/// A chart.
pub struct Picture<'a> {
    /// Above it.
    pub title: &'a str,
    /// Quantity and unit of the axis to the right.
    pub x: &'a str,
    /// Quantity and unit of the axis upwards.
    pub y: &'a str,
    /// What it shows.
    pub lines: Vec<Line<'a>>,
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 70.0;
const TOP: f64 = 50.0;
const COLOURS: [&str; 6] = [
    "#1f6fb4", "#d1495b", "#2e8b57", "#e0a030", "#7b5ea7", "#555555",
];

impl Picture<'_> {
    /// Writes it to `target/pictures/NAME.svg` and returns where that is.
    ///
    /// # Errors
    ///
    /// What the file system says.
    pub fn save(&self, name: &str) -> io::Result<PathBuf> {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/pictures");
        self.save_in(&folder, name)
    }

    /// The same in a folder of one's own.
    ///
    /// # Errors
    ///
    /// What the file system says.
    pub fn save_in(&self, folder: &Path, name: &str) -> io::Result<PathBuf> {
        fs::create_dir_all(folder)?;
        let path = folder.join(format!("{name}.svg"));
        fs::write(&path, self.svg())?;
        Ok(path)
    }

    fn svg(&self) -> String {
        let range = |axis: usize| {
            let values = self.lines.iter().flat_map(|line| &line.points);
            let (low, high) = values
                .map(|point| point[axis])
                .filter(|value| value.is_finite())
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(value), high.max(value))
                });
            match (low.is_finite(), high > low) {
                (false, _) => (0.0, 1.0),
                (true, false) => (low - 1.0, low + 1.0),
                (true, true) => (low, high),
            }
        };
        let ((x0, x1), (y0, y1)) = (range(0), range(1));
        let right = |x: f64| LEFT + (x - x0) / (x1 - x0) * (WIDTH - LEFT - 20.0);
        let up = |y: f64| HEIGHT - TOP - (y - y0) / (y1 - y0) * (HEIGHT - 2.0 * TOP);
        let mut svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {HEIGHT}' font-family='sans-serif' \
             font-size='12'><rect width='100%' height='100%' fill='white'/>\
             <text x='{LEFT}' y='20' font-size='15'>{}</text>",
            self.title
        );
        for y in ticks(y0, y1) {
            let _ = write!(
                svg,
                "<path d='M{LEFT} {0:.1}H{1:.1}' stroke='#ddd'/><text x='{2}' y='{3:.1}' text-anchor='end'>{y}</text>",
                up(y),
                WIDTH - 20.0,
                LEFT - 6.0,
                up(y) + 4.0
            );
        }
        for x in ticks(x0, x1) {
            let _ = write!(
                svg,
                "<text x='{:.1}' y='{}' text-anchor='middle'>{x}</text>",
                right(x),
                HEIGHT - TOP + 18.0
            );
        }
        for (line, (index, colour)) in self.lines.iter().zip(COLOURS.iter().cycle().enumerate()) {
            let mut path = String::new();
            let mut pen_down = false;
            for point in &line.points {
                if point.iter().all(|value| value.is_finite()) {
                    let letter = if pen_down { 'L' } else { 'M' };
                    let _ = write!(path, "{letter}{:.1} {:.1}", right(point[0]), up(point[1]));
                    pen_down = true;
                } else {
                    pen_down = false;
                }
            }
            let _ = write!(
                svg,
                "<path d='{path}' fill='none' stroke='{colour}' stroke-width='1.5'/>\
                 <text x='{}' y='38' fill='{colour}'>{}</text>",
                LEFT + 140.0 * index as f64,
                line.name
            );
        }
        let _ = write!(
            svg,
            "<text x='{}' y='{}' text-anchor='middle'>{}</text>\
             <text transform='translate(14 {}) rotate(-90)' text-anchor='middle'>{}</text></svg>",
            WIDTH / 2.0,
            HEIGHT - 8.0,
            self.x,
            HEIGHT / 2.0,
            self.y
        );
        svg
    }
}

/// Round numbers from `low` to `high`, four to ten of them.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / 5.0;
    let decade = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|factor| factor * decade)
        .into_iter()
        .find(|step| *step >= rough)
        .unwrap_or(rough);
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    // Rounded, lest 0.3 show as 0.30000000000000004.
    let round = |value: f64| (value / decade).round() * decade;
    let digits = (-decade.log10().floor()).max(0.0) as i32;
    (first..=last)
        .map(|n| round(n as f64 * step))
        .map(|value| (value * 10f64.powi(digits)).round() / 10f64.powi(digits))
        .collect()
}
