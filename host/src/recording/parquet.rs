//! The same in columns, for data frames: Parquet.
//!
//! Such a file can be read only once its end is written. So a recording is made as CSV, which survives
//! whatever happens, and becomes Parquet when it is over.

mod rows;

use std::fmt::Write;
use std::fs::{self, File};
use std::mem;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::Compression;
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use super::columns::{Cell, Cells, Column, Kind, cells, columns};
use super::csv::write_entry;
use super::{Entry, Reader, VERSION};
use crate::failure::{self, Failure};
pub use rows::{Next, Rows, damaged, open};

/// Under which the file says that it is one of ours, and its version.
const KEY: &str = "vrduino.recording";
/// Under which the head stands, as in CSV.
const HEAD: &str = "vrduino.head";
/// Under which stands what was said, a line each: before which row, and as in CSV.
const REMARKS: &str = "vrduino.remarks";

/// Rows that are kept together: a minute at a thousand a second.
const GROUP: usize = 1 << 16;

/// Writes what is left of a recording.
///
/// # Errors
///
/// It cannot be read, or the file cannot be written; then there is none.
pub fn write(recording: &mut Reader, path: &Path) -> Result<(), Failure> {
    let refused = |why: String| {
        let sentence = format!("{} cannot be written: {why}", path.display());
        Failure::new(failure::Kind::File, sentence)
    };
    let file = File::create(path).map_err(|error| refused(error.to_string()))?;
    let mut table = Table::new(recording, file).map_err(|error| refused(error.to_string()))?;
    let written = loop {
        match recording.read() {
            Ok(Some(entry)) => {
                if let Err(error) = table.take(&entry) {
                    break Err(refused(error.to_string()));
                }
            }
            Ok(None) => break table.finish().map_err(|error| refused(error.to_string())),
            Err(failure) => break Err(failure),
        }
    };
    if written.is_err() {
        // Half of one cannot be read.
        let _ = fs::remove_file(path);
    }
    written
}

struct Table {
    writer: SerializedFileWriter<File>,
    columns: &'static [Column],
    group: Vec<Cells>,
    rows: u64,
    segment: i32,
    remarks: String,
}

impl Table {
    fn new(recording: &Reader, file: File) -> Result<Self, ParquetError> {
        let head = recording.head();
        let columns = columns(head.has_counts);
        let mut text = String::new();
        head.write(&mut text);
        let facts = vec![
            KeyValue::new(KEY.to_owned(), VERSION.to_string()),
            KeyValue::new(HEAD.to_owned(), text),
        ];
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(facts))
            .build();
        let schema = parse_message_type(&schema(columns))?;
        let writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))?;
        Ok(Self {
            writer,
            columns,
            group: Vec::new(),
            rows: 0,
            segment: -1,
            remarks: String::new(),
        })
    }

    fn take(&mut self, entry: &Entry) -> Result<(), ParquetError> {
        match entry {
            Entry::Row(row) => {
                self.segment += i32::from(row.sample.is_first);
                self.group.push(cells(row, self.segment.max(0)));
                self.rows += 1;
                if self.group.len() == GROUP {
                    self.write_group()?;
                }
            }
            Entry::Remark(_) => {
                // Into a string nothing fails.
                let _ = write!(self.remarks, "{} ", self.rows);
                write_entry(entry, 0, false, &mut self.remarks);
            }
        }
        Ok(())
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for (place, column) in self.columns.iter().enumerate() {
            let Some(mut writer) = group.next_column()? else {
                break;
            };
            let cells = self.group.iter().map(|cells| cells[place]);
            write_column(writer.untyped(), column, cells)?;
            writer.close()?;
        }
        group.close()?;
        self.group.clear();
        Ok(())
    }

    fn finish(mut self) -> Result<(), ParquetError> {
        if !self.group.is_empty() {
            self.write_group()?;
        }
        let remarks = mem::take(&mut self.remarks);
        self.writer
            .append_key_value_metadata(KeyValue::new(REMARKS.to_owned(), remarks));
        self.writer.close()?;
        Ok(())
    }
}

fn write_column(
    writer: &mut ColumnWriter<'_>,
    column: &Column,
    cells: impl Iterator<Item = Cell> + Clone,
) -> Result<(), ParquetError> {
    let present: Option<Vec<i16>> = column.optional.then(|| {
        cells
            .clone()
            .map(|cell| i16::from(cell != Cell::Empty))
            .collect()
    });
    let present = present.as_deref();
    match writer {
        ColumnWriter::DoubleColumnWriter(writer) => {
            let values: Vec<f64> = cells
                .filter_map(|cell| match cell {
                    Cell::Number(value) => Some(value),
                    _ => None,
                })
                .collect();
            writer.write_batch(&values, present, None)?;
        }
        ColumnWriter::Int32ColumnWriter(writer) => {
            let values: Vec<i32> = cells
                .filter_map(|cell| match cell {
                    Cell::Integer(value) => Some(value),
                    _ => None,
                })
                .collect();
            writer.write_batch(&values, present, None)?;
        }
        ColumnWriter::BoolColumnWriter(writer) => {
            let values: Vec<bool> = cells
                .filter_map(|cell| match cell {
                    Cell::Flag(value) => Some(value),
                    _ => None,
                })
                .collect();
            writer.write_batch(&values, present, None)?;
        }
        ColumnWriter::ByteArrayColumnWriter(writer) => {
            let values: Vec<ByteArray> = cells
                .filter_map(|cell| match cell {
                    Cell::Word(word) => Some(word.into()),
                    _ => None,
                })
                .collect();
            writer.write_batch(&values, present, None)?;
        }
        // The schema below has no others.
        _ => {}
    }
    Ok(())
}

fn schema(columns: &[Column]) -> String {
    let mut text = String::from("message recording {\n");
    for column in columns {
        let needed = if column.optional {
            "optional"
        } else {
            "required"
        };
        let (kind, meaning) = match column.kind {
            Kind::Decimals(_) | Kind::Exact => ("double", ""),
            Kind::Integer => ("int32", ""),
            Kind::Flag => ("boolean", ""),
            Kind::Compass => ("binary", " (UTF8)"),
        };
        let _ = writeln!(text, "{needed} {kind} {}{meaning};", column.name);
    }
    text + "}"
}
