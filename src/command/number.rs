//! Decimal numbers as people type them.
//!
//! The standard library's parser is exact for every string there is, with tables that `0.98` does not
//! need.

/// Most digits that are looked at; more than single precision can tell apart.
const DIGITS: usize = 9;

/// `-12.5`, `3`, `.25`: an optional sign, digits, and an optional point among them. Nothing else: no
/// exponent, no infinity. Right to the last digit but one of single precision.
pub fn parse(word: &str) -> Option<f32> {
    let (sign, digits) = match word.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, word.strip_prefix('+').unwrap_or(word)),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let length = whole.len() + fraction.len();
    if length == 0 || length > DIGITS {
        return None;
    }
    let mut value: u32 = 0;
    for byte in whole.bytes().chain(fraction.bytes()) {
        if !byte.is_ascii_digit() {
            return None;
        }
        value = value * 10 + u32::from(byte - b'0');
    }
    let scale = 10_u32.pow(fraction.len() as u32);
    Some(sign * (value as f32 / scale as f32))
}
