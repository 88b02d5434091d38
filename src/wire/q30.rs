//! The quaternion as the wire takes it: integers, for a core without a floating-point unit.

use nalgebra::UnitQuaternion;

/// w, x, y and z with 30 fraction bits each, from −2 to just below 2: body to world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Q30(pub [i32; 4]);

impl Q30 {
    /// No turn.
    pub const IDENTITY: Self = Self([1 << 30, 0, 0, 0]);

    /// The same numbers, exactly.
    pub fn components(self) -> [f64; 4] {
        self.0.map(|bits| f64::from(bits) / f64::from(1 << 30))
    }
}

impl From<&UnitQuaternion<f32>> for Q30 {
    /// To the nearest bit, halves away from zero; exactly from 2⁻⁷ on. 2 or more is just below 2, and
    /// what is not a number 0.
    fn from(q: &UnitQuaternion<f32>) -> Self {
        Self([q.w, q.i, q.j, q.k].map(nearest))
    }
}

/// In integers, which costs less than the product and the rounding would without a floating-point unit.
fn nearest(value: f32) -> i32 {
    let bits = value.to_bits();
    // value = significand · 2^(exponent − 150), so with 30 fraction bits the shift is exponent − 120.
    let exponent = bits >> 23 & 0xFF;
    let significand = bits & 0x007F_FFFF | 0x0080_0000;
    let magnitude = match exponent {
        _ if value.is_nan() => 0,
        128.. => i32::MAX,
        120.. => (significand << (exponent - 120)) as i32,
        96.. => {
            let shift = 120 - exponent;
            ((significand + (1 << (shift - 1))) >> shift) as i32
        }
        _ => 0,
    };
    if value.is_sign_negative() {
        -magnitude
    } else {
        magnitude
    }
}
