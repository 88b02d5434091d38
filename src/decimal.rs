//! Decimals written without floating point: exactly rounded, and without the tables of the standard
//! library.

use core::fmt::{self, Write};
use nalgebra::{RealField, try_convert};

/// A value with so many decimals, at most 6, for messages.
///
/// It is rounded to the nearest decimal, halves away from zero, exactly (the value of the float is
/// what is rounded, not a product of it). Zero has no sign. A value of a million or more is written
/// as ±999999.999…, infinities too, and what is not a number as 0: a parser meets digits in every
/// case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decimal(pub f32, pub u32);

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write_to(f)
    }
}

impl Decimal {
    /// The same without a formatter.
    ///
    /// # Errors
    ///
    /// Those of `out`.
    pub fn write_to(self, out: &mut impl Write) -> fmt::Result {
        let Self(value, decimals) = self;
        let decimals = decimals.min(6);
        let one = 10_u64.pow(decimals);
        let steps = magnitude_in_steps(value, one);
        if value < 0.0 && steps > 0 {
            out.write_char('-')?;
        }
        write_digits(out, steps / one, 1)?;
        if decimals == 0 {
            return Ok(());
        }
        out.write_char('.')?;
        write_digits(out, steps % one, decimals as usize)
    }
}

/// A scalar of either precision with so many decimals.
pub(crate) fn rounded<T: RealField + Copy>(value: T, decimals: u32) -> Decimal {
    Decimal(try_convert(value).unwrap_or(f32::NAN), decimals)
}

/// |value| in steps of 1/`per_one`, to the nearest, halves up.
fn magnitude_in_steps(value: f32, per_one: u64) -> u64 {
    let largest = 1_000_000 * per_one - per_one.div_ceil(1000);
    if value.is_nan() {
        return 0;
    }
    if value.abs() >= 1e6 {
        return largest;
    }
    // value = significand × 2^-shift. Below a million, shift is at least 4, and significand ×
    // per_one has at most 24 + 17 bits.
    let bits = value.to_bits();
    let exponent = (bits >> 23) & 0xFF;
    let fraction = u64::from(bits & 0x007F_FFFF);
    let (significand, shift) = match exponent {
        0 => (fraction, 149),
        _ => (fraction | 0x0080_0000, 150 - exponent),
    };
    let product = significand * per_one;
    let half = 1_u64.checked_shl(shift - 1).unwrap_or(u64::MAX / 2);
    let rounded = (product + half).checked_shr(shift).unwrap_or(0);
    rounded.min(largest)
}

/// Decimal digits, padded with zeros on the left to at least `width`.
#[inline(never)] // with its loops unrolled, half a kilobyte for every place it is called from
pub(crate) fn write_digits(out: &mut impl Write, mut value: u64, width: usize) -> fmt::Result {
    let mut digits = [b'0'; 20];
    let mut used = 0;
    for place in digits.iter_mut().rev() {
        // 32-bit division is an instruction on the target, 64-bit division a routine.
        if let Ok(small) = u32::try_from(value) {
            *place = b'0' + (small % 10) as u8;
            value = u64::from(small / 10);
        } else {
            *place = b'0' + (value % 10) as u8;
            value /= 10;
        }
        used += 1;
        if value == 0 && used >= width {
            break;
        }
    }
    for &digit in digits.iter().skip(digits.len() - used) {
        out.write_char(char::from(digit))?;
    }
    Ok(())
}
