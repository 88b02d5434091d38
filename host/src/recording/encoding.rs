//! Entries as bytes of the stream again, by the encoder of the board.

use vrduino::wire::orientation::{Decimals, Tag};
use vrduino::wire::{self, Provenance, Q30, Stamp, frame};

use super::{Entry, Row, Voice};
use crate::stream::Sample;

/// How an orientation is to be sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// `QC w x y z`, three decimals: what the course's pages read
    #[default]
    Text,
    /// The same with number, time and checksum, where they are known
    Timed,
    /// Frames, where number and time are known
    Binary,
    /// As it came: everything that is known, as exactly as it is
    #[value(skip)]
    AsItCame,
}

/// Appends an entry. What the recorder noted is for readers of the file.
pub fn encode(entry: &Entry, format: Format, bytes: &mut Vec<u8>) {
    match entry {
        Entry::Row(row) => encode_row(row, format, bytes),
        Entry::Remark(remark) if remark.voice == Voice::Board => {
            bytes.extend(wire::text(&remark.text).as_bytes());
        }
        Entry::Remark(_) => {}
    }
}

fn encode_row(Row { sample, registers }: &Row, format: Format, bytes: &mut Vec<u8>) {
    let q = q30(sample);
    let stamp = sample.sequence.map(|sequence| Stamp {
        sequence,
        micros: micros(sample.time),
    });
    // Without a status a sample came as a line; a frame has to say something, and says nothing special.
    let as_frame = match format {
        Format::Text | Format::Timed => false,
        Format::Binary => true,
        Format::AsItCame => sample.status.is_some(),
    };
    match stamp {
        Some(stamp) if as_frame => {
            let status = sample.status.unwrap_or_default();
            let provenance = Provenance { stamp, status };
            match registers {
                Some(counts) if format == Format::AsItCame => {
                    bytes.extend(frame::orientation_and_counts(q, provenance, counts));
                }
                _ => bytes.extend(frame::orientation(q, provenance)),
            }
        }
        Some(stamp) if format != Format::Text => {
            let decimals = match format {
                Format::AsItCame => Decimals::MOST_TIMED,
                _ => Decimals::COURSE,
            };
            bytes.extend(wire::timed(q, stamp, decimals).as_bytes());
        }
        _ => {
            let decimals = match format {
                Format::AsItCame => Decimals::new(6).unwrap_or(Decimals::COURSE),
                _ => Decimals::COURSE,
            };
            bytes.extend(wire::quaternion(Tag::Fused, q, decimals).as_bytes());
        }
    }
}

/// As the board had it, if it came with 30 fraction bits.
fn q30(sample: &Sample) -> Q30 {
    let q = sample.orientation.quaternion();
    let one = f64::from(1 << 30);
    Q30([q.w, q.i, q.j, q.k].map(|component| (component * one).round() as i32))
}

/// The board's count, which wraps.
fn micros(seconds: f64) -> u32 {
    ((seconds * 1e6).round() as i64) as u32
}
