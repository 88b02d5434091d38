//! What stands in a row: the columns of a recording, and a row as cells and back.

use nalgebra::{Quaternion, UnitQuaternion};
use vrduino::sensor::RawSample;
use vrduino::sensor::magnetometer::{RawField, Resolution};
use vrduino::wire::Status;
use vrduino::wire::frame::Counts;
use vrduino::wire::provenance::Compass;

use super::Row;
use crate::stream::Sample;

/// How a column is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number with so many decimals.
    Decimals(usize),
    /// A number with as many digits as it takes to get the same one back.
    Exact,
    /// An integer.
    Integer,
    /// 0 or 1.
    Flag,
    /// One of [`COMPASS`].
    Compass,
}

/// A column.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// As in the header.
    pub name: &'static str,
    /// How it is written.
    pub kind: Kind,
    /// Whether a row can do without.
    pub optional: bool,
}

const fn always(name: &'static str, kind: Kind) -> Column {
    Column {
        name,
        kind,
        optional: false,
    }
}

const fn at_times(name: &'static str, kind: Kind) -> Column {
    Column {
        name,
        kind,
        optional: true,
    }
}

/// All of them; the registers, from [`PLAIN`] on, only where they were recorded.
pub const COLUMNS: [Column; 26] = [
    always("time_s", Kind::Decimals(6)),
    always("arrival_s", Kind::Decimals(6)),
    always("segment", Kind::Integer),
    at_times("sequence", Kind::Integer),
    always("w", Kind::Exact),
    always("x", Kind::Exact),
    always("y", Kind::Exact),
    always("z", Kind::Exact),
    at_times("delay_ms", Kind::Decimals(3)),
    at_times("repeated", Kind::Flag),
    at_times("clipped", Kind::Flag),
    at_times("still", Kind::Flag),
    at_times("compass", Kind::Compass),
    at_times("notes", Kind::Flag),
    at_times("bias_measured", Kind::Flag),
    at_times("skipped", Kind::Flag),
    at_times("gyro_x", Kind::Integer),
    at_times("gyro_y", Kind::Integer),
    at_times("gyro_z", Kind::Integer),
    at_times("accel_x", Kind::Integer),
    at_times("accel_y", Kind::Integer),
    at_times("accel_z", Kind::Integer),
    at_times("temperature", Kind::Integer),
    at_times("field_x", Kind::Integer),
    at_times("field_y", Kind::Integer),
    at_times("field_z", Kind::Integer),
];

/// How many there are without the registers.
pub const PLAIN: usize = 16;

/// Those of a recording with or without registers.
pub fn columns(has_counts: bool) -> &'static [Column] {
    &COLUMNS[..if has_counts { COLUMNS.len() } else { PLAIN }]
}

/// What the magnetometer does for the heading, in words.
pub const COMPASS: [(Compass, &str); 4] = [
    (Compass::Absent, "absent"),
    (Compass::Unused, "unused"),
    (Compass::Followed, "followed"),
    (Compass::Disturbed, "disturbed"),
];

/// What stands in a row under a column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Cell {
    /// Nothing: it is not known.
    #[default]
    Empty,
    /// A finite number.
    Number(f64),
    /// An integer.
    Integer(i32),
    /// Yes or no.
    Flag(bool),
    /// A word of [`COMPASS`].
    Word(&'static str),
}

/// A row, cell by cell.
pub type Cells = [Cell; COLUMNS.len()];

/// The row in cells. Segments count from 0.
pub fn cells(row: &Row, segment: i32) -> Cells {
    let Row { sample, registers } = row;
    let q = sample.orientation.quaternion();
    let mut cells = Cells::default();
    cells[0] = Cell::Number(sample.time);
    cells[1] = Cell::Number(sample.arrival);
    cells[2] = Cell::Integer(segment);
    cells[3] = integer(sample.sequence);
    for (cell, value) in cells[4..8].iter_mut().zip([q.w, q.i, q.j, q.k]) {
        *cell = Cell::Number(value);
    }
    cells[8] = sample
        .delay
        .map_or(Cell::Empty, |delay| Cell::Number(delay * 1e3));
    if let Some(status) = sample.status {
        let word = COMPASS
            .into_iter()
            .find(|&(compass, _)| compass == status.compass);
        cells[9] = Cell::Flag(status.repeated);
        cells[10] = Cell::Flag(status.clipped);
        cells[11] = Cell::Flag(status.still);
        cells[12] = word.map_or(Cell::Empty, |(_, word)| Cell::Word(word));
        cells[13] = Cell::Flag(status.notes);
        cells[14] = Cell::Flag(status.bias_measured);
        cells[15] = Cell::Flag(status.skipped);
    }
    if let Some(Counts { sample, field }) = registers {
        let words = sample.gyro.into_iter().chain(sample.accel);
        let words = words.chain([sample.temperature]);
        let field = field.iter().flat_map(|field| field.counts);
        for (cell, word) in cells[PLAIN..].iter_mut().zip(words.chain(field)) {
            *cell = integer(Some(word));
        }
    }
    cells
}

fn integer<T: Into<i32>>(value: Option<T>) -> Cell {
    value.map_or(Cell::Empty, |value| Cell::Integer(value.into()))
}

/// The row these cells are, and its segment; or what is wrong with them.
pub fn row(cells: &Cells) -> Result<(Row, i32), String> {
    let reader = Cursor(cells);
    let q = Quaternion::new(
        reader.number(4)?,
        reader.number(5)?,
        reader.number(6)?,
        reader.number(7)?,
    );
    // As the decoder of the stream.
    if (q.norm() - 1.0).abs() > 0.01 {
        return Err("w, x, y and z should be a quaternion of length 1".into());
    }
    let sample = Sample {
        time: reader.time(0)?,
        arrival: reader.time(1)?,
        orientation: UnitQuaternion::new_unchecked(q),
        sequence: reader.integer(3)?,
        status: reader.status()?,
        delay: match cells[8] {
            Cell::Empty => None,
            _ => Some(reader.number(8)? * 1e-3),
        },
        is_first: false,
    };
    let registers = reader.registers(sample.status)?;
    let segment = reader.wanted(2)?;
    Ok((Row { sample, registers }, segment))
}

struct Cursor<'a>(&'a Cells);

impl Cursor<'_> {
    fn number(&self, at: usize) -> Result<f64, String> {
        match self.0[at] {
            Cell::Number(value) => Ok(value),
            _ => Err(missing(at)),
        }
    }

    /// Thirty years are enough.
    fn time(&self, at: usize) -> Result<f64, String> {
        let time = self.number(at)?;
        match time.abs() {
            ..1e9 => Ok(time),
            _ => Err(format!("{} cannot be {time}", COLUMNS[at].name)),
        }
    }

    fn integer<T: TryFrom<i32>>(&self, at: usize) -> Result<Option<T>, String> {
        match self.0[at] {
            Cell::Integer(value) => {
                let name = COLUMNS[at].name;
                let value = T::try_from(value).map_err(|_| format!("{name} cannot be {value}"))?;
                Ok(Some(value))
            }
            _ => Ok(None),
        }
    }

    fn wanted<T: TryFrom<i32>>(&self, at: usize) -> Result<T, String> {
        self.integer(at)?.ok_or_else(|| missing(at))
    }

    fn flag(&self, at: usize) -> Result<bool, String> {
        match self.0[at] {
            Cell::Flag(value) => Ok(value),
            _ => Err(missing(at)),
        }
    }

    /// All of it, or none.
    fn status(&self) -> Result<Option<Status>, String> {
        if self.0[9..PLAIN].iter().all(|&cell| cell == Cell::Empty) {
            return Ok(None);
        }
        let compass = COMPASS
            .into_iter()
            .find(|&(_, word)| self.0[12] == Cell::Word(word));
        Ok(Some(Status {
            repeated: self.flag(9)?,
            clipped: self.flag(10)?,
            still: self.flag(11)?,
            compass: compass.ok_or_else(|| missing(12))?.0,
            notes: self.flag(13)?,
            bias_measured: self.flag(14)?,
            skipped: self.flag(15)?,
        }))
    }

    /// All seven of them, or none; and the field's three, or none.
    fn registers(&self, status: Option<Status>) -> Result<Option<Counts>, String> {
        if self.0[PLAIN..].iter().all(|&cell| cell == Cell::Empty) {
            return Ok(None);
        }
        let three =
            |at| Ok::<_, String>([self.wanted(at)?, self.wanted(at + 1)?, self.wanted(at + 2)?]);
        let sample = RawSample {
            gyro: three(16)?,
            accel: three(19)?,
            temperature: self.wanted(22)?,
            fresh: !status.unwrap_or_default().repeated,
        };
        let has_field = self.0[23..].iter().any(|&cell| cell != Cell::Empty);
        let field = match has_field {
            true => Some(RawField {
                counts: three(23)?,
                resolution: Resolution::Bits16,
                overflow: false,
            }),
            false => None,
        };
        Ok(Some(Counts { sample, field }))
    }
}

fn missing(at: usize) -> String {
    format!("{} is missing", COLUMNS[at].name)
}
