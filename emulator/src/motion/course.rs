//! The course's recordings: rows of six numbers without a header, one every 2 ms.
//!
//! A row is gyroscope x, y, z (°/s) and accelerometer x, y, z (m/s²) in the body frame, y up at
//! rest. The course hands them out as a C array, `simulatedImuData.h` (2464 rows), so the array's
//! decoration is accepted around the numbers: a declaration up to the first brace, inner braces
//! around rows, a trailing comma, `//` and `/* */` comments, everything after a `#`, and the `f`
//! of a C float. Numbers are separated by commas, white space or both.
//!
//! Inside braces the numbers may be broken into lines anywhere; without braces every line is one
//! row.

use super::csv::number;
use super::recording::Recording;
use super::{Instant, MotionError};

/// The time between two rows (s).
pub const PERIOD: f64 = 0.002;

/// Gyroscope and accelerometer, three axes each.
const ROW: usize = 6;

/// Whether a text is bare rows or a C array, rather than a table that begins with column names.
pub fn looks_like_rows(text: &str) -> bool {
    let text = without_comments(text);
    let begins_with_number = text
        .chars()
        .find(|c| !c.is_whitespace() && *c != '\u{feff}');
    text.contains('{')
        || begins_with_number.is_some_and(|c| c.is_ascii_digit() || "+-.".contains(c))
}

/// A piece of the text and where it stands.
struct Token<'a> {
    line: usize,
    column: usize,
    text: &'a str,
}

impl Token<'_> {
    fn wrong(&self, problem: String) -> MotionError {
        MotionError::Text {
            line: self.line,
            column: self.column,
            problem,
        }
    }
}

/// Reads rows.
///
/// # Errors
///
/// [`MotionError`] with line and column if something is neither a number nor decoration, if a row
/// does not have six numbers, or if braces do not match.
pub fn parse(text: &str) -> Result<Recording, MotionError> {
    let text = without_comments(text.trim_start_matches('\u{feff}'));
    let values = match text.find('{') {
        None => lines_of_six(&text)?,
        Some(brace) => array(&text, brace)?,
    };
    if values.len() % ROW != 0 {
        return Err(MotionError::Rows {
            numbers: values.len(),
        });
    }
    let samples = values
        .as_chunks::<ROW>()
        .0
        .iter()
        .enumerate()
        .map(|(index, &[gx, gy, gz, ax, ay, az])| {
            let rate = [gx, gy, gz].map(f64::to_radians);
            (
                index as f64 * PERIOD,
                Instant {
                    rate,
                    force: [ax, ay, az],
                    field: None,
                    truth: None,
                },
            )
        })
        .collect();
    Recording::new("course recording", samples).ok_or(MotionError::Empty)
}

/// Rows as bare lines.
fn lines_of_six(text: &str) -> Result<Vec<f64>, MotionError> {
    let mut values = Vec::new();
    let mut row: Option<(usize, usize)> = None;
    for token in tokens(text, 0) {
        match row {
            Some((line, length)) if line == token.line => row = Some((line, length + 1)),
            _ => {
                full(row)?;
                row = Some((token.line, 1));
            }
        }
        values.push(value(&token)?);
    }
    full(row)?;
    Ok(values)
}

/// Checks that a line, given with its length, is one row.
fn full(row: Option<(usize, usize)>) -> Result<(), MotionError> {
    match row {
        Some((line, length)) if length != ROW => Err(MotionError::Text {
            line,
            column: 1,
            problem: format!(
                "{length} numbers in a row that should have six (gyroscope x, y, z in °/s, accelerometer x, y, z \
                 in m/s²); a table with a time column needs a first line that names its columns"
            ),
        }),
        _ => Ok(()),
    }
}

/// Rows as a C array whose first brace stands at `brace`.
fn array(text: &str, brace: usize) -> Result<Vec<f64>, MotionError> {
    let mut values = Vec::new();
    let mut depth = 0_usize;
    let mut began = 0;
    let mut finished = false;
    for token in tokens(text, brace) {
        // Rows of a table that was cut out of its array: one brace around each and none around all.
        let next_row = token.text == "{" && values.len() - began == ROW;
        match token.text {
            ";" if finished => {}
            _ if finished && !next_row => {
                return Err(token.wrong(format!(
                    "{:?} after the end of the array; keep one array in the file",
                    token.text
                )));
            }
            "{" => {
                depth += 1;
                began = values.len();
                finished = false;
            }
            "}" => {
                // Inner braces hold one row each; only the outermost may hold all of them.
                if depth > 1 && values.len() - began != ROW {
                    return Err(token.wrong(format!(
                        "a row of {} numbers where six belong",
                        values.len() - began
                    )));
                }
                depth -= 1;
                finished = depth == 0;
                if !finished {
                    began = values.len();
                }
            }
            _ => values.push(value(&token)?),
        }
    }
    if finished {
        Ok(values)
    } else {
        let lines = text.lines().count();
        Err(MotionError::Text {
            line: lines,
            column: 1,
            problem: "the file ends inside the array: it is cut; copy it again".to_owned(),
        })
    }
}

fn value(token: &Token<'_>) -> Result<f64, MotionError> {
    let digits = token.text.trim_end_matches(['f', 'F']);
    number(digits).ok_or_else(|| {
        token.wrong(format!(
            "{:?} is not a number of reasonable size",
            token.text
        ))
    })
}

/// The numbers and braces from byte `start` on. Commas and white space only separate them.
fn tokens(text: &str, start: usize) -> impl Iterator<Item = Token<'_>> {
    let mut offset = 0;
    text.split_inclusive('\n')
        .enumerate()
        .flat_map(move |(index, line)| {
            let begin = start.saturating_sub(offset).min(line.len());
            offset += line.len();
            pieces(line, begin).map(move |(at, text)| Token {
                line: index + 1,
                column: line[..at].chars().count() + 1,
                text,
            })
        })
}

/// The pieces of a line from byte `at` on, each with its place.
fn pieces(line: &str, mut at: usize) -> impl Iterator<Item = (usize, &str)> {
    std::iter::from_fn(move || {
        let separates = |c: char| c == ',' || c.is_whitespace();
        let alone = |c: char| "{};".contains(c);
        at += line[at..].find(|c| !separates(c))?;
        let rest = &line[at..];
        let length = match rest.find(|c| separates(c) || alone(c)) {
            Some(0) => 1,
            Some(length) => length,
            None => rest.len(),
        };
        let piece = (at, &rest[..length]);
        at += length;
        Some(piece)
    })
}

/// The text with every comment turned into spaces, so that places stay the same.
fn without_comments(text: &str) -> String {
    #[derive(Clone, Copy, PartialEq)]
    enum Part {
        Code,
        Line,
        Block,
    }
    let mut out = String::with_capacity(text.len());
    let mut part = Part::Code;
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        let kept = match (part, c, characters.peek()) {
            (_, '\n', _) => {
                if part == Part::Line {
                    part = Part::Code;
                }
                '\n'
            }
            (Part::Code, '#', _) | (Part::Code, '/', Some('/')) => {
                part = Part::Line;
                ' '
            }
            (Part::Code, '/', Some('*')) | (Part::Block, '*', Some('/')) => {
                part = if part == Part::Code {
                    Part::Block
                } else {
                    Part::Code
                };
                characters.next();
                out.push(' ');
                ' '
            }
            (Part::Code, c, _) => c,
            _ => ' ',
        };
        out.push(kept);
    }
    out
}
