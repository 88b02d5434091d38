//! Binary frames: a zero, a message stuffed by [`cobs`](super::cobs), a zero.
//!
//! A message, little-endian:
//!
//! | byte | | |
//! |---|---|---|
//! | 0 | kind | 1 orientation, 2 and 3 counts |
//! | 1 | [`Status`] | a bit each |
//! | 2 | sequence | u16 |
//! | 4 | device time, µs | u32 |
//! | 8 | what the kind has | orientation: w, x, y, z, i32 with 30 fraction bits |
//! | last 2 | [`crc16`] of all before | u16 |
//!
//! No message is longer than thirty bytes. So what follows a zero tells a frame from a line: a frame's
//! first byte says how far its first run goes, 31 at most, and no letter is below 32.

use super::cobs::{stuff, unstuff};
use super::crc::crc16;
use super::{PACKET_LEN, Provenance, Q30, Stamp, Status};
use crate::sensor::RawSample;
use crate::sensor::magnetometer::{RawField, Resolution};
use heapless::Vec;

/// One frame or two, zeros included, ready to be sent as one packet.
pub type Frame = Vec<u8, PACKET_LEN>;

/// Longest message.
pub const MESSAGE_LEN: usize = 30;

/// Longest message, stuffed, without the zeros around it.
pub const STUFFED_LEN: usize = MESSAGE_LEN + 1;

/// Before what the kind has.
const HEADER: usize = 8;

const ORIENTATION: u8 = 1;
const COUNTS: u8 = 2;
const COUNTS_WITH_FIELD: u8 = 3;

/// What a frame holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message {
    /// Where the board points.
    Orientation(Q30, Provenance),
    /// What the sensor's registers held, of which the orientation with the same stamp was made.
    Counts(Counts, Stamp),
    /// Whole, but of a kind that is not known here.
    Unknown(u8),
}

/// The sensor's registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Gyro, accelerometer and temperature.
    pub sample: RawSample,
    /// The magnetometer's, at 16 bits, where a new measurement came with the sample.
    pub field: Option<RawField>,
}

/// Why a frame, or a line, is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// It is not built as it should be.
    Malformed,
    /// Its checksum is another: bytes are wrong, or missing.
    Checksum,
}

/// The frame of an orientation: 29 bytes.
#[inline(never)] // a function of its own in the image, which the emulator times
pub fn orientation(q: Q30, provenance: Provenance) -> Frame {
    let mut frame = Frame::new();
    append(
        &mut frame,
        ORIENTATION,
        provenance,
        q.0.map(i32::to_le_bytes),
    );
    frame
}

/// The same, and in the same packet the counts it was made of: 56 bytes, 62 with a field. A field that
/// overflowed, or is not of 16 bits, is left out.
pub fn orientation_and_counts(q: Q30, provenance: Provenance, counts: &Counts) -> Frame {
    let mut frame = orientation(q, provenance);
    let RawSample {
        gyro,
        accel,
        temperature,
        fresh: _, // the status says so
    } = counts.sample;
    let field = counts
        .field
        .filter(|field| field.resolution == Resolution::Bits16 && !field.overflow);
    let kind = match field {
        Some(_) => COUNTS_WITH_FIELD,
        None => COUNTS,
    };
    let field = field.iter().flat_map(|field| field.counts);
    let words = gyro.into_iter().chain(accel).chain([temperature]);
    let words = words.chain(field).map(i16::to_le_bytes);
    append(&mut frame, kind, provenance, words);
    frame
}

/// One more frame, which always fits: see the lengths above.
fn append<const N: usize>(
    frame: &mut Frame,
    kind: u8,
    from: Provenance,
    payload: impl IntoIterator<Item = [u8; N]>,
) {
    let Provenance { stamp, status } = from;
    let [low, high] = stamp.sequence.to_le_bytes();
    let [a, b, c, d] = stamp.micros.to_le_bytes();
    let start = frame.len();
    // A zero, and the place in front of the message that the stuffing needs.
    let opening = [0, 0, kind, status.to_byte(), low, high, a, b, c, d];
    let _ = frame.extend_from_slice(&opening);
    for word in payload {
        let _ = frame.extend_from_slice(&word);
    }
    let crc = crc16(frame.get(start + 2..).unwrap_or_default());
    let _ = frame.extend_from_slice(&crc.to_le_bytes());
    let _ = stuff(frame.get_mut(start + 1..).unwrap_or_default());
    let _ = frame.push(0);
}

/// What stood between two zeros.
///
/// # Errors
///
/// [`Damage`] says why it is no frame.
pub fn parse(stuffed: &[u8]) -> Result<Message, Damage> {
    let mut bytes: Vec<u8, STUFFED_LEN> =
        Vec::from_slice(stuffed).map_err(|_| Damage::Malformed)?;
    let message = unstuff(&mut bytes).ok_or(Damage::Malformed)?;
    let (body, crc) = message.split_last_chunk().ok_or(Damage::Malformed)?;
    if crc16(body) != u16::from_le_bytes(*crc) {
        return Err(Damage::Checksum);
    }
    let (header, payload) = body
        .split_first_chunk::<HEADER>()
        .ok_or(Damage::Malformed)?;
    let [kind, status, low, high, a, b, c, d] = *header;
    let status = Status::from_byte(status);
    let stamp = Stamp {
        sequence: u16::from_le_bytes([low, high]),
        micros: u32::from_le_bytes([a, b, c, d]),
    };
    match kind {
        ORIENTATION => {
            let (words, rest) = payload.as_chunks();
            let words: &[[u8; 4]; 4] = words.try_into().map_err(|_| Damage::Malformed)?;
            if !rest.is_empty() {
                return Err(Damage::Malformed);
            }
            let q = Q30(words.map(i32::from_le_bytes));
            Ok(Message::Orientation(q, Provenance { stamp, status }))
        }
        COUNTS | COUNTS_WITH_FIELD => {
            let counts = counts(payload, kind == COUNTS_WITH_FIELD, !status.repeated);
            let counts = counts.ok_or(Damage::Malformed)?;
            Ok(Message::Counts(counts, stamp))
        }
        other => Ok(Message::Unknown(other)),
    }
}

fn counts(payload: &[u8], with_field: bool, fresh: bool) -> Option<Counts> {
    let (words, rest) = payload.as_chunks();
    let mut words = words.iter().copied().map(i16::from_le_bytes);
    let three =
        |words: &mut dyn Iterator<Item = i16>| Some([words.next()?, words.next()?, words.next()?]);
    let sample = RawSample {
        gyro: three(&mut words)?,
        accel: three(&mut words)?,
        temperature: words.next()?,
        fresh,
    };
    let field = with_field.then(|| three(&mut words));
    let field = match field {
        Some(counts) => Some(RawField {
            counts: counts?,
            resolution: Resolution::Bits16,
            overflow: false,
        }),
        None => None,
    };
    let whole = words.next().is_none() && rest.is_empty();
    whole.then_some(Counts { sample, field })
}
