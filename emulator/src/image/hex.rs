//! Intel HEX: the text a loader reads.

use ihex::{ReaderError, Record};

use super::ImageError;
use super::configuration;
use super::flash::Flash;

/// Bytes in a row that is written.
const ROW: usize = 32;

/// The text of the file if it looks like Intel HEX: the first thing in it is a colon.
pub(super) fn text(bytes: &[u8]) -> Option<&str> {
    let text = std::str::from_utf8(bytes).ok()?;
    text.trim_start().starts_with(':').then_some(text)
}

pub(super) fn read(text: &str) -> Result<Flash, ImageError> {
    let mut flash = Flash::erased();
    let mut base = 0_u64;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() {
            continue;
        }
        let wrong = |error| ImageError::HexLine {
            line: index + 1,
            problem: plainly(error),
        };
        match Record::from_record_string(line).map_err(wrong)? {
            Record::Data { offset, value } => flash.program(base + u64::from(offset), &value)?,
            Record::ExtendedLinearAddress(upper) => base = u64::from(upper) << 16,
            Record::ExtendedSegmentAddress(segment) => base = u64::from(segment) << 4,
            // Where an x86 would start; this processor reads its vector table.
            Record::StartLinearAddress(_) | Record::StartSegmentAddress { .. } => {}
            Record::EndOfFile => return Ok(flash),
        }
    }
    Err(ImageError::HexCut)
}

fn plainly(error: ReaderError) -> String {
    match error {
        ReaderError::ChecksumMismatch(computed, written) => {
            format!("its checksum is {written:02X} but its bytes give {computed:02X}")
        }
        other => other.to_string(),
    }
}

/// Writes `flash`, from address 0, as Intel HEX.
pub(super) fn write(flash: &[u8]) -> String {
    let mut records = Vec::new();
    let mut upper = 0_u16;
    for (index, row) in flash.chunks(ROW).enumerate() {
        let address = index * ROW;
        let erased = row.iter().all(|&byte| byte == 0xFF);
        if erased && address != configuration::ADDRESS as usize {
            continue;
        }
        // The flash is 256 KiB, so the upper half of an address is at most 3.
        let halves = [(address >> 16) as u16, (address & 0xFFFF) as u16];
        if halves[0] != upper {
            upper = halves[0];
            records.push(Record::ExtendedLinearAddress(upper));
        }
        records.push(Record::Data {
            offset: halves[1],
            value: row.to_vec(),
        });
    }
    records.push(Record::EndOfFile);
    ihex::create_object_file_representation(&records)
        .expect("rows of 32 bytes and one end always make an object")
}
