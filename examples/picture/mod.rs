//! Lines over an axis, as an SVG file: all that the examples draw.

#![allow(dead_code)] // Not everyone who draws has use for every stroke and scale.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{fs, io};

mod scale;
pub use scale::Scale;

/// How a line is drawn, so that it does not hide the others.
#[derive(Clone, Copy, PartialEq)]
pub enum Stroke {
    /// Broad and pale, beneath the others: the truth.
    Broad,
    /// Thin and pale: what is noisy.
    Fine,
    /// As lines are.
    Plain,
    /// Where it may lie on another.
    Dashed,
}

/// A line with its name. Lines are drawn in their order, the last on top.
pub struct Line<'a> {
    /// As the legend has it; empty if it is another of the one before.
    pub name: &'a str,
    /// Its points; a point that is not finite interrupts the line.
    pub points: Vec<[f64; 2]>,
}

/// A chart.
pub struct Picture<'a> {
    /// Above it: what is asked, and of which motion.
    pub title: &'a str,
    /// Quantity and unit of the axis to the right.
    pub x: &'a str,
    /// Quantity and unit of the axis upwards.
    pub y: &'a str,
    /// What it shows.
    pub lines: Vec<Line<'a>>,
}

/// How a picture is drawn.
#[derive(Default)]
pub struct Look<'a> {
    /// How its axes are laid out, that to the right and that upwards.
    pub scales: [Scale; 2],
    /// How its lines are drawn; plain where there is none.
    pub strokes: &'a [Stroke],
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 52.0;
const BOTTOM: f64 = 50.0;
const COLOURS: [&str; 6] = [
    "#1f6fb4", "#d1495b", "#2e8b57", "#e0a030", "#7b5ea7", "#555555",
];

impl Picture<'_> {
    /// Writes it to `target/pictures/NAME.svg`, with plain lines over even axes, and returns where
    /// that is.
    ///
    /// # Errors
    ///
    /// What the file system says.
    pub fn save(&self, name: &str) -> io::Result<PathBuf> {
        self.save_with(name, &Look::default())
    }

    /// The same with a look of its own.
    ///
    /// # Errors
    ///
    /// What the file system says.
    pub fn save_with(&self, name: &str, look: &Look) -> io::Result<PathBuf> {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/pictures");
        self.write(&folder, name, look)
    }

    /// As [`Picture::save`], in a folder of one's own.
    ///
    /// # Errors
    ///
    /// What the file system says.
    pub fn save_in(&self, folder: &Path, name: &str) -> io::Result<PathBuf> {
        self.write(folder, name, &Look::default())
    }

    fn write(&self, folder: &Path, name: &str, look: &Look) -> io::Result<PathBuf> {
        fs::create_dir_all(folder)?;
        let path = folder.join(format!("{name}.svg"));
        fs::write(&path, self.svg(look))?;
        Ok(path)
    }

    fn svg(&self, look: &Look) -> String {
        let [x_axis, y_axis] = [0, 1].map(|axis| {
            let points = self.lines.iter().flat_map(|line| &line.points);
            look.scales[axis].axis(points.map(|point| point[axis]))
        });
        let right = |x: f64| LEFT + x_axis.place(x) * (WIDTH - LEFT - RIGHT);
        let up = |y: f64| HEIGHT - BOTTOM - y_axis.place(y) * (HEIGHT - TOP - BOTTOM);
        let mut svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {HEIGHT}' font-family='sans-serif' \
             font-size='12'><rect width='100%' height='100%' fill='white'/>\
             <text x='{LEFT}' y='20' font-size='15'>{}</text>",
            escaped(self.title)
        );
        for (y, label) in &y_axis.ticks {
            let _ = write!(
                svg,
                "<path d='M{LEFT} {0:.1}H{1:.1}' stroke='#ddd'/><text x='{2}' y='{3:.1}' text-anchor='end'>{label}</text>",
                up(*y),
                WIDTH - RIGHT,
                LEFT - 6.0,
                up(*y) + 4.0
            );
        }
        for (x, label) in &x_axis.ticks {
            let _ = write!(
                svg,
                "<path d='M{0:.1} {1}v5' stroke='#999'/><text x='{0:.1}' y='{2}' text-anchor='middle'>{label}</text>",
                right(*x),
                HEIGHT - BOTTOM,
                HEIGHT - BOTTOM + 18.0
            );
        }
        let mut colours = COLOURS.iter().cycle();
        let mut legend = LEFT;
        let strokes = look.strokes.iter().chain(std::iter::repeat(&Stroke::Plain));
        for (line, stroke) in self.lines.iter().zip(strokes) {
            let style = match (stroke, colours.clone().next().unwrap_or(&"black")) {
                (Stroke::Broad, _) => "stroke='#bbb' stroke-width='5'".to_owned(),
                (Stroke::Fine, colour) => {
                    format!("stroke='{colour}' stroke-width='0.8' opacity='0.6'")
                }
                (Stroke::Plain, colour) => format!("stroke='{colour}' stroke-width='1.5'"),
                (Stroke::Dashed, colour) => {
                    format!("stroke='{colour}' stroke-width='1.5' stroke-dasharray='6 4'")
                }
            };
            if *stroke != Stroke::Broad {
                colours.next();
            }
            let mut path = String::new();
            let mut last: Option<f64> = None;
            for [x, y] in &line.points {
                if !right(*x).is_finite() || !up(*y).is_finite() {
                    last = None;
                    continue;
                }
                let goes_on = last.is_some_and(|last| !look.scales[1].jumps(last, *y));
                let letter = if goes_on { 'L' } else { 'M' };
                let _ = write!(path, "{letter}{:.1} {:.1}", right(*x), up(*y));
                last = Some(*y);
            }
            let _ = write!(svg, "<path d='{path}' fill='none' {style}/>");
            if line.name.is_empty() {
                continue;
            }
            let _ = write!(
                svg,
                "<path d='M{legend} 36h18' {style}/>\
                 <text x='{}' y='40'>{}</text>",
                legend + 23.0,
                escaped(line.name)
            );
            legend += 48.0 + 6.5 * line.name.chars().count() as f64;
        }
        let _ = write!(
            svg,
            "<text x='{}' y='{}' text-anchor='middle'>{}</text>\
             <text transform='translate(14 {}) rotate(-90)' text-anchor='middle'>{}</text></svg>",
            WIDTH / 2.0,
            HEIGHT - 8.0,
            escaped(self.x),
            HEIGHT / 2.0,
            escaped(self.y)
        );
        svg
    }
}

/// A name of a file may have signs in it that mean something in SVG.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
