//! `QC w x y z` and what may stand behind it.

use crate::wire::Stamp;
use crate::wire::crc::crc16;
use crate::wire::frame::Damage;

/// The four numbers, and the stamp where there is one.
type Orientation = ([f64; 4], Option<Stamp>);

/// A line without its end. None if it does not claim to be an orientation.
pub fn parse(line: &str) -> Option<Result<Orientation, Damage>> {
    line.starts_with("QC ").then(|| orientation(line))
}

fn orientation(line: &str) -> Result<Orientation, Damage> {
    let (body, stamped) = match line.split_once('*') {
        None => (line, false),
        Some((body, crc)) => {
            if hexadecimal(crc).ok_or(Damage::Malformed)? != crc16(body.as_bytes()) {
                return Err(Damage::Checksum);
            }
            // The space before the asterisk is the checksum's.
            (body.strip_suffix(' ').ok_or(Damage::Malformed)?, true)
        }
    };
    fields(body, stamped).ok_or(Damage::Malformed)
}

fn fields(body: &str, stamped: bool) -> Option<Orientation> {
    let mut words = body.split(' ').skip(1);
    let mut components = [0.0; 4];
    for component in &mut components {
        *component = number(words.next()?)?;
    }
    let stamp = match stamped {
        false => None,
        true => Some(Stamp {
            sequence: digits(words.next()?)?.parse().ok()?,
            micros: digits(words.next()?)?.parse().ok()?,
        }),
    };
    words.next().is_none().then_some((components, stamp))
}

/// No exponent and no `inf`: nobody sends these.
fn number(word: &str) -> Option<f64> {
    let digits_only = |byte: u8| byte.is_ascii_digit() || matches!(byte, b'-' | b'.');
    word.bytes().all(digits_only).then(|| word.parse().ok())?
}

fn digits(word: &str) -> Option<&str> {
    word.bytes()
        .all(|byte| byte.is_ascii_digit())
        .then_some(word)
}

/// Four digits, capitals only: as they are sent.
fn hexadecimal(word: &str) -> Option<u16> {
    let digits = word.len() == 4 && word.bytes().all(|b| matches!(b, b'0'..=b'9' | b'A'..=b'F'));
    digits.then(|| u16::from_str_radix(word, 16).ok())?
}
