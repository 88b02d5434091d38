//! Entries as lines of text, and back.

use std::fmt::Write;

use super::columns::{COMPASS, Cell, Cells, Column, Kind, cells, columns, row};
use super::{Entry, Head, Remark, Row, SIGNATURE, VERSION, Voice};

/// What the last line begins and ends with; between them is how many rows there are.
const END: (&str, &str) = ("end, ", " samples");

/// What a line says.
#[derive(Debug, PartialEq)]
pub enum Said {
    /// A row, and its segment.
    Row(Row, i32),
    /// Something between the rows.
    Remark(Remark),
    /// It is over, after so many rows.
    End(u64),
    /// Nothing that is known here.
    Nothing,
}

/// Head and header.
pub fn write_head(head: &Head, text: &mut String) {
    // Here and below: into a string nothing fails.
    let _ = writeln!(text, "{SIGNATURE}{VERSION}");
    head.write(text);
    text.push_str(&header(head.has_counts));
    text.push('\n');
}

/// The names of the columns.
pub fn header(has_counts: bool) -> String {
    let names: Vec<_> = columns(has_counts).iter().map(|c| c.name).collect();
    names.join(",")
}

/// An entry, as one line.
pub fn write_entry(entry: &Entry, segment: i32, has_counts: bool, text: &mut String) {
    match entry {
        Entry::Row(row) => {
            let cells = cells(row, segment);
            for (place, (column, cell)) in columns(has_counts).iter().zip(cells).enumerate() {
                if place > 0 {
                    text.push(',');
                }
                let _ = match (cell, column.kind) {
                    (Cell::Empty, _) => Ok(()),
                    (Cell::Number(value), Kind::Decimals(count)) => write!(text, "{value:.count$}"),
                    (Cell::Number(value), _) => write!(text, "{value}"),
                    (Cell::Integer(value), _) => write!(text, "{value}"),
                    (Cell::Flag(flag), _) => write!(text, "{}", u8::from(flag)),
                    (Cell::Word(word), _) => write!(text, "{word}"),
                };
            }
        }
        Entry::Remark(Remark {
            at,
            voice,
            text: said,
        }) => {
            let _ = write!(text, "# {} {at:.6} {said}", voice.word());
        }
    }
    text.push('\n');
}

/// The last line.
pub fn write_end(samples: u64, text: &mut String) {
    let _ = writeln!(text, "# {}{samples}{}", END.0, END.1);
}

/// What a line below the header says; or what is wrong with it.
pub fn read(line: &str, has_counts: bool) -> Result<Said, String> {
    match line.strip_prefix('#') {
        Some(comment) => Ok(read_comment(comment.trim_start())),
        None => {
            let (row, segment) = row(&read_cells(line, has_counts)?)?;
            Ok(Said::Row(row, segment))
        }
    }
}

fn read_comment(comment: &str) -> Said {
    let samples = comment
        .strip_prefix(END.0)
        .and_then(|rest| rest.strip_suffix(END.1));
    if let Some(Ok(samples)) = samples.map(str::parse) {
        return Said::End(samples);
    }
    remark(comment).map_or(Said::Nothing, Said::Remark)
}

fn remark(comment: &str) -> Option<Remark> {
    let (word, rest) = comment.split_once(' ')?;
    let voice = Voice::ALL.into_iter().find(|voice| voice.word() == word)?;
    let (at, text) = rest.split_once(' ').unwrap_or((rest, ""));
    let at = finite(at)?;
    Some(Remark::new(at, voice, text))
}

fn read_cells(line: &str, has_counts: bool) -> Result<Cells, String> {
    let columns = columns(has_counts);
    let mut cells = Cells::default();
    let mut fields = line.split(',');
    for (place, column) in columns.iter().enumerate() {
        let Some(field) = fields.next() else {
            let wanted = columns.len();
            return Err(format!(
                "{wanted} fields are expected, and {place} are there"
            ));
        };
        cells[place] = cell(column, field.trim())?;
    }
    match fields.count() {
        0 => Ok(cells),
        more => {
            let (wanted, found) = (columns.len(), columns.len() + more);
            Err(format!(
                "{wanted} fields are expected, and {found} are there"
            ))
        }
    }
}

fn cell(column: &Column, field: &str) -> Result<Cell, String> {
    if field.is_empty() && column.optional {
        return Ok(Cell::Empty);
    }
    let (cell, expected) = match column.kind {
        Kind::Decimals(_) | Kind::Exact => (finite(field).map(Cell::Number), "a number"),
        Kind::Integer => (field.parse().ok().map(Cell::Integer), "an integer"),
        Kind::Flag => {
            let flag = match field {
                "0" => Some(false),
                "1" => Some(true),
                _ => None,
            };
            (flag.map(Cell::Flag), "0 or 1")
        }
        Kind::Compass => {
            let word = COMPASS.into_iter().find(|&(_, word)| word == field);
            let cell = word.map(|(_, word)| Cell::Word(word));
            (cell, "absent, unused, followed or disturbed")
        }
    };
    cell.ok_or_else(|| {
        let found: String = field.chars().take(20).collect();
        format!("{} should be {expected}, and is `{found}`", column.name)
    })
}

fn finite(field: &str) -> Option<f64> {
    field.parse().ok().filter(|value: &f64| value.is_finite())
}
