//! Tables of comma-separated values with a line of column names.
//!
//! ```text
//! # a nod
//! t,gx,gy,gz,ax,ay,az
//! 0.000,0.00,0,0,0,9.81,0
//! 0.005,0.12,0,0,0,9.81,0
//! ```
//!
//! | column | meaning | unit | with the unit in the name |
//! |---|---|---|---|
//! | `t` | time, strictly increasing | s | `t_s`, `t_ms`, `t_us` |
//! | `gx`, `gy`, `gz` | angular rate about the body axes | rad/s | `gx_rad` … (rad/s), `gx_dps` … (°/s) |
//! | `ax`, `ay`, `az` | specific force along the body axes | m/s² | `ax_ms2` … (m/s²), `ax_g` … (9.80665 m/s²) |
//! | `mx`, `my`, `mz` | optional magnetic flux density along the body axes | µT | `mx_ut` … |
//! | `qw`, `qx`, `qy`, `qz` | optional truth body → world, y up | – | – |
//!
//! Columns come in any order, in upper or lower case; others are ignored. Blank lines and everything
//! after a `#` are skipped. The first time is the motion's beginning, whatever its value.

use super::recording::Recording;
use super::rotation::normalized;
use super::{Instant, MotionError};

/// The standard value of gravity (m/s²), the unit g.
const STANDARD_GRAVITY: f64 = 9.806_65;

/// The largest number that is accepted in any column. Far beyond what a sensor can feel, and keeps
/// all later arithmetic finite.
pub(super) const LARGEST: f64 = 1.0e9;

/// What a column can hold, in the order in which a row is kept.
const QUANTITIES: [&str; 14] = [
    "t", "gx", "gy", "gz", "ax", "ay", "az", "qw", "qx", "qy", "qz", "mx", "my", "mz",
];

/// Time, rates and forces: the quantities no table can do without.
const REQUIRED: usize = 7;

/// The quantities that come all together or not at all: the truth and the magnetic field.
const TRUTH: std::ops::Range<usize> = 7..11;
const FIELD: std::ops::Range<usize> = 11..14;

/// Where each quantity stands in a row, and what turns it into the unit of [`Instant`].
struct Columns {
    places: [Option<(usize, f64)>; QUANTITIES.len()],
    width: usize,
}

/// A line of the table with its number, from 1, without its comment.
type Line<'a> = (usize, &'a str);

/// Reads a table.
///
/// # Errors
///
/// [`MotionError`] with line and column if a column is missing, named twice or half of a set, if a
/// row has another number of values than there are names, if a value is not a number, if time does
/// not increase, or if a truth is not a rotation.
pub fn parse(text: &str) -> Result<Recording, MotionError> {
    let text = text.trim_start_matches('\u{feff}');
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.split('#').next().unwrap_or("")))
        .filter(|(_, line)| !line.trim().is_empty());
    let columns = Columns::named(lines.next().ok_or(MotionError::Empty)?)?;

    let mut samples: Vec<(f64, Instant)> = Vec::new();
    for line in lines {
        let sample = columns.sample(line)?;
        if let Some((before, _)) = samples.last()
            && sample.0 <= *before
        {
            return Err(MotionError::Text {
                line: line.0,
                column: columns.character(line.1, 0),
                problem: format!(
                    "the time {} s does not come after {before} s; sort the rows and drop repeated ones",
                    sample.0
                ),
            });
        }
        samples.push(sample);
    }
    Recording::new("table", samples).ok_or(MotionError::Empty)
}

impl Columns {
    fn named((line, names): Line<'_>) -> Result<Self, MotionError> {
        let wrong = |problem: String| MotionError::Columns { line, problem };
        let mut places = [None; QUANTITIES.len()];
        let mut width = 0;
        for name in names.split(',') {
            if let Some((quantity, factor)) = quantity(&name.trim().to_ascii_lowercase())
                && places[quantity].replace((width, factor)).is_some()
            {
                return Err(wrong(format!("two columns hold {}", QUANTITIES[quantity])));
            }
            width += 1;
        }
        let missing = |range: std::ops::Range<usize>| -> Vec<&str> {
            range
                .filter(|&i| places[i].is_none())
                .map(|i| QUANTITIES[i])
                .collect()
        };
        let absent = missing(0..REQUIRED);
        if !absent.is_empty() {
            return Err(wrong(format!("there is no column {}", absent.join(", "))));
        }
        for (name, columns) in [("truth", TRUTH), ("magnetic field", FIELD)] {
            let absent = missing(columns.clone());
            if !absent.is_empty() && absent.len() < columns.len() {
                return Err(wrong(format!(
                    "the {name} lacks the column {}",
                    absent.join(", ")
                )));
            }
        }
        Ok(Self { places, width })
    }

    fn sample(&self, (line, row): Line<'_>) -> Result<(f64, Instant), MotionError> {
        let fields: Vec<&str> = row.split(',').collect();
        if fields.len() != self.width {
            return Err(MotionError::Text {
                line,
                column: 1,
                problem: format!(
                    "{} values where the first line names {} columns; one is missing or too many",
                    fields.len(),
                    self.width
                ),
            });
        }
        let mut values = [0.0; QUANTITIES.len()];
        for (quantity, place) in self.places.iter().enumerate() {
            if let Some((field, factor)) = place {
                let value = number(fields[*field]).ok_or_else(|| MotionError::Text {
                    line,
                    column: self.character(row, quantity),
                    problem: format!(
                        "{:?} for {} is not a number of reasonable size",
                        fields[*field].trim(),
                        QUANTITIES[quantity]
                    ),
                })?;
                values[quantity] = value * factor;
            }
        }
        let [t, gx, gy, gz, ax, ay, az, qw, qx, qy, qz, field @ ..] = values;
        let truth = [qw, qx, qy, qz];
        let truth = match self.places[TRUTH.start] {
            None => None,
            Some(_) => Some(normalized(truth).ok_or_else(|| MotionError::Text {
                line,
                column: self.character(row, TRUTH.start),
                problem: format!("{truth:?} is not a unit quaternion w, x, y, z"),
            })?),
        };
        Ok((
            t,
            Instant {
                rate: [gx, gy, gz],
                force: [ax, ay, az],
                field: self.places[FIELD.start].map(|_| field),
                truth,
            },
        ))
    }

    /// The character, from 1, at which the value of a quantity begins in a row.
    fn character(&self, row: &str, quantity: usize) -> usize {
        let field = self.places[quantity].map_or(0, |(field, _)| field);
        let before: usize = row
            .split(',')
            .take(field)
            .map(|f| f.chars().count() + 1)
            .sum();
        let blanks = row
            .split(',')
            .nth(field)
            .map_or(0, |f| f.chars().take_while(|c| c.is_whitespace()).count());
        before + blanks + 1
    }
}

/// Which quantity a column name means, and the factor to its unit in [`Instant`]; `None` for a
/// column that is not used.
fn quantity(name: &str) -> Option<(usize, f64)> {
    let (symbol, unit) = name.split_once('_').unwrap_or((name, ""));
    let quantity = QUANTITIES.iter().position(|&known| known == symbol)?;
    let factor = match (quantity, unit) {
        (_, "") => 1.0,
        (0, "s") => 1.0,
        (0, "ms") => 1.0e-3,
        (0, "us") => 1.0e-6,
        (1..=3, "rad") => 1.0,
        (1..=3, "dps") => 1.0_f64.to_radians(),
        (4..=6, "ms2") => 1.0,
        (4..=6, "g") => STANDARD_GRAVITY,
        (11..=13, "ut") => 1.0,
        _ => return None,
    };
    Some((quantity, factor))
}

/// A finite number of a size that can be meant.
pub(super) fn number(text: &str) -> Option<f64> {
    let value: f64 = text.trim().parse().ok()?;
    (value.abs() <= LARGEST).then_some(value)
}
