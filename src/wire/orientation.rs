//! `QC w x y z`, the course's line, and the same with its provenance behind it.

use super::crc::crc16;
use super::{Line, Q30, Stamp, end, push, push_digits};
use crate::decimal::write_q30;

/// Which orientation a quaternion line shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tag {
    /// “QC”: the complementary filter.
    Fused,
    /// “QG”: the gyro alone.
    Gyro,
}

/// How many decimals the numbers of a quaternion are written with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Decimals(u32);

impl Decimals {
    /// The course's.
    pub const COURSE: Self = Self(3);
    /// The most that leave room for the provenance in one packet.
    pub const MOST_TIMED: Self = Self(5);

    /// From 3, which the course's pages expect, to 6, which is what single precision has.
    pub fn new(decimals: u32) -> Option<Self> {
        (3..=6).contains(&decimals).then_some(Self(decimals))
    }

    /// As a number.
    pub fn get(self) -> u32 {
        self.0
    }
}

/// `QC w x y z` or `QG w x y z`: body to world, scalar first.
///
/// Each number is rounded to the nearest decimal, exactly, halves away from zero, and zero has no sign.
/// At three decimals their norm is within 0.001 of that of `q`.
pub fn quaternion(tag: Tag, q: Q30, decimals: Decimals) -> Line {
    end(numbers(tag, q, decimals))
}

/// `QC w x y z sequence micros *crc`: the fused orientation with its [`Stamp`], at most
/// [`PACKET_LEN`](super::PACKET_LEN) bytes. More than five decimals are written as five, or it would not fit.
///
/// The checksum is four hexadecimal digits, [`crc16`] of everything before the asterisk.
pub fn timed(q: Q30, stamp: Stamp, decimals: Decimals) -> Line {
    let mut line = numbers(Tag::Fused, q, decimals.min(Decimals::MOST_TIMED));
    push(&mut line, " ");
    push_digits(&mut line, u64::from(stamp.sequence), 1);
    push(&mut line, " ");
    push_digits(&mut line, u64::from(stamp.micros), 1);
    push(&mut line, " ");
    let crc = crc16(line.as_bytes());
    push(&mut line, "*");
    for place in [12, 8, 4, 0] {
        let digit = char::from_digit(u32::from(crc >> place & 0xF), 16);
        // A line has room for this, and four bits are a digit.
        let _ = line.push(digit.unwrap_or('0').to_ascii_uppercase());
    }
    end(line)
}

fn numbers(tag: Tag, q: Q30, decimals: Decimals) -> Line {
    let mut line = Line::new();
    push(
        &mut line,
        match tag {
            Tag::Fused => "QC",
            Tag::Gyro => "QG",
        },
    );
    for bits in q.0 {
        push(&mut line, " ");
        // Four numbers of nine bytes are no line's end.
        let _ = write_q30(&mut line, bits, decimals.get());
    }
    line
}
