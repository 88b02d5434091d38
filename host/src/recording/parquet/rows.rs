//! Columns as rows again.

use std::fmt;
use std::fs::File;
use std::path::Path;

use parquet::column::reader::ColumnReader;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::super::columns::{COLUMNS, COMPASS, Cell, Cells, PLAIN, columns, row};
use super::super::csv::{self, Said};
use super::super::reader::{no_recording, other_version};
use super::{HEAD, KEY, REMARKS};
use crate::failure::{Failure, Kind};
use crate::recording::{Head, Remark, Row, VERSION};

/// Rows that are read at a time.
const BATCH: usize = 4096;

/// What comes next.
#[derive(Debug)]
pub enum Next {
    /// A row, and its segment.
    Row(Row, i32),
    /// Something between the rows.
    Remark(Remark),
}

/// Reads them.
pub struct Rows {
    file: SerializedFileReader<File>,
    has_counts: bool,
    /// The group that is read, its columns, and how many rows of it are left.
    group: usize,
    columns: Vec<ColumnReader>,
    left: usize,
    /// Rows that are read, the next last.
    batch: Vec<Cells>,
    /// Rows that are handed out.
    rows: u64,
    /// What is said, and before which row, the next last.
    remarks: Vec<(u64, Remark)>,
}

impl fmt::Debug for Rows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Rows")
            .field("rows", &self.rows)
            .finish_non_exhaustive()
    }
}

/// A file that begins like one.
pub fn open(path: &Path, file: File) -> Result<(Head, Rows), Failure> {
    let file = SerializedFileReader::new(file)
        .map_err(|error| damaged(path, &format!("its end is missing or damaged ({error})")))?;
    let metadata = file.metadata().file_metadata();
    let fact = |name: &str| {
        let facts = metadata.key_value_metadata()?;
        let found = facts.iter().find(|fact| fact.key == name)?;
        found.value.as_deref()
    };
    match fact(KEY).map(str::parse) {
        Some(Ok(VERSION)) => {}
        Some(Ok(other)) => return Err(other_version(path, other)),
        _ => return Err(no_recording(path)),
    }
    let mut head = Head::default();
    for line in fact(HEAD).unwrap_or_default().lines() {
        head.learn(line.trim_start_matches("# "));
    }
    let schema = metadata.schema_descr();
    head.has_counts = schema.num_columns() != PLAIN;
    let expected = columns(head.has_counts);
    let names = schema.columns().iter().map(|column| column.name());
    if !names.eq(expected.iter().map(|column| column.name)) {
        return Err(damaged(path, "its columns are not those of a recording"));
    }
    let mut remarks: Vec<_> = fact(REMARKS)
        .unwrap_or_default()
        .lines()
        .filter_map(|line| {
            let (row, rest) = line.split_once(' ')?;
            match csv::read(rest, false) {
                Ok(Said::Remark(remark)) => Some((row.parse().ok()?, remark)),
                _ => None,
            }
        })
        .collect();
    remarks.reverse();
    let rows = Rows {
        has_counts: head.has_counts,
        file,
        group: 0,
        columns: Vec::new(),
        left: 0,
        batch: Vec::new(),
        rows: 0,
        remarks,
    };
    Ok((head, rows))
}

/// A file that is not as it should be.
pub fn damaged(path: &Path, what: &str) -> Failure {
    Failure::new(Kind::File, format!("{} is damaged: {what}", path.display()))
}

impl Rows {
    /// The next, or what is wrong with it.
    pub fn read(&mut self) -> Result<Option<Next>, String> {
        if self.batch.is_empty() {
            self.read_batch().map_err(|error| error.to_string())?;
        }
        let is_over = self.batch.is_empty();
        if let Some((_, remark)) = self
            .remarks
            .pop_if(|(before, _)| is_over || *before <= self.rows)
        {
            return Ok(Some(Next::Remark(remark)));
        }
        let Some(cells) = self.batch.pop() else {
            return Ok(None);
        };
        self.rows += 1;
        let (row, segment) = row(&cells).map_err(|what| format!("row {}: {what}", self.rows))?;
        Ok(Some(Next::Row(row, segment)))
    }

    fn read_batch(&mut self) -> Result<(), ParquetError> {
        while self.left == 0 {
            if self.group == self.file.num_row_groups() {
                return Ok(());
            }
            let group = self.file.get_row_group(self.group)?;
            self.group += 1;
            self.left = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
            self.columns = (0..columns(self.has_counts).len())
                .map(|place| group.get_column_reader(place))
                .collect::<Result<_, _>>()?;
        }
        let count = self.left.min(BATCH);
        self.left -= count;
        self.batch = vec![Cells::default(); count];
        for (place, column) in self.columns.iter_mut().enumerate() {
            let cells = read_column(column, place, count)?;
            for (cells, cell) in self.batch.iter_mut().zip(cells) {
                cells[place] = cell;
            }
        }
        self.batch.reverse();
        Ok(())
    }
}

fn read_column(
    column: &mut ColumnReader,
    place: usize,
    count: usize,
) -> Result<Vec<Cell>, ParquetError> {
    let mut present = Vec::new();
    // What is not as it should be is found missing by who makes a row of it.
    let values: Vec<Cell> = match column {
        ColumnReader::DoubleColumnReader(reader) => {
            let mut values = Vec::new();
            reader.read_records(count, Some(&mut present), None, &mut values)?;
            let finite = |value: f64| match value.is_finite() {
                true => Cell::Number(value),
                false => Cell::Empty,
            };
            values.into_iter().map(finite).collect()
        }
        ColumnReader::Int32ColumnReader(reader) => {
            let mut values = Vec::new();
            reader.read_records(count, Some(&mut present), None, &mut values)?;
            values.into_iter().map(Cell::Integer).collect()
        }
        ColumnReader::BoolColumnReader(reader) => {
            let mut values = Vec::new();
            reader.read_records(count, Some(&mut present), None, &mut values)?;
            values.into_iter().map(Cell::Flag).collect()
        }
        ColumnReader::ByteArrayColumnReader(reader) => {
            let mut values = Vec::new();
            reader.read_records(count, Some(&mut present), None, &mut values)?;
            let known = |value: parquet::data_type::ByteArray| {
                COMPASS
                    .into_iter()
                    .find(|(_, word)| word.as_bytes() == value.data())
                    .map_or(Cell::Empty, |(_, word)| Cell::Word(word))
            };
            values.into_iter().map(known).collect()
        }
        _ => Vec::new(),
    };
    if !COLUMNS[place].optional {
        return Ok(values);
    }
    let mut values = values.into_iter();
    let cell = |level: i16| match level {
        0 => Cell::Empty,
        _ => values.next().unwrap_or_default(),
    };
    Ok(present.into_iter().map(cell).collect())
}
