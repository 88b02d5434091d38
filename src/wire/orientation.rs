//! `QC w x y z`, the course's line, and the same with its provenance behind it.

use super::crc::crc16;
use super::from_the_end::FromTheEnd;
use super::{Line, PACKET_LEN, Q30, Stamp};

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
#[inline(never)] // a function of its own in the image, which the emulator times
pub fn quaternion(tag: Tag, q: Q30, decimals: Decimals) -> Line {
    let mut text = FromTheEnd::new();
    text.put(b'\n');
    put_quaternion(&mut text, tag, q, decimals);
    line(&text)
}

/// `QC w x y z sequence micros *crc`: the fused orientation with its [`Stamp`], at most
/// [`PACKET_LEN`] bytes. More than five decimals are written as five, or it would not fit.
///
/// The checksum is four hexadecimal digits, [`crc16`] of everything before the asterisk.
#[inline(never)] // as above
pub fn timed(q: Q30, stamp: Stamp, decimals: Decimals) -> Line {
    let mut text = FromTheEnd::new();
    text.put(b' ');
    text.put_number(stamp.micros);
    text.put(b' ');
    text.put_number(u32::from(stamp.sequence));
    text.put(b' ');
    put_quaternion(&mut text, Tag::Fused, q, decimals.min(Decimals::MOST_TIMED));
    let mut line = line(&text);
    let crc = crc16(text.text());
    let _ = line.push('*');
    for place in [12, 8, 4, 0] {
        // Four bits are a digit. Here and below: a line has room for all of this.
        let digit = char::from_digit(u32::from(crc >> place & 0xF), 16).unwrap_or('0');
        let _ = line.push(digit.to_ascii_uppercase());
    }
    let _ = line.push('\n');
    line
}

/// A line, or everything before its checksum.
type Text = FromTheEnd<PACKET_LEN>;

fn put_quaternion(text: &mut Text, tag: Tag, q: Q30, decimals: Decimals) {
    for bits in q.0.into_iter().rev() {
        text.put_q30(bits, decimals.get());
        text.put(b' ');
    }
    text.put(match tag {
        Tag::Fused => b'C',
        Tag::Gyro => b'G',
    });
    text.put(b'Q');
}
#[inline(always)] // or it would be copied once more
fn line(text: &Text) -> Line {
    let mut line = Line::new();
    for &byte in text.text() {
        let _ = line.push(char::from(byte));
    }
    line
}
