//! Series for the angles of the tilt correction.

use super::multiply::{Multiply, Portable};
use super::number::Q;

/// arctan(r)/r for r² from 0 to 1: from 1 down to π/4. Relative error 6.5e-7: the minimax polynomial of degree 6
/// in r² − ½, by Remez' exchange. As Q30, highest power first.
pub const ARC_TANGENT_PER_RATIO: [i32; 7] = q30([
    0.007_863_377_0,
    -0.013_422_871_1,
    0.020_826_350_4,
    -0.040_003_593_3,
    0.083_419_404_1,
    -0.203_760_844_4,
    0.870_419_648_5,
]);

/// r² (arctan(r)/r)³/3, the second term of tan(s arctan r)/r as a series of s; error 7.3e-5 of arctan(r)/r. In
/// the same form.
pub const TANGENT_TERM: [i32; 7] = q30([
    0.0,
    0.0,
    -0.050_668_000_8,
    0.077_368_945_6,
    -0.103_906_004_7,
    0.142_018_314_2,
    0.109_896_604_8,
]);

const fn q30(values: [f64; 7]) -> [i32; 7] {
    let mut bits = [0; 7];
    let mut term = 0;
    while term < bits.len() {
        bits[term] = Q::<Portable, 30>::constant(values[term]).bits();
        term += 1;
    }
    bits
}

/// cos h for h from 0 to π/2: its series up to h¹⁴, which leaves 7e-11.
#[inline]
pub fn cosine<M: Multiply>(h_squared: Q<M, 29>) -> Q<M, 30> {
    horner(
        h_squared,
        const {
            [
                Q::constant(-1.0 / 87_178_291_200.0),
                Q::constant(1.0 / 479_001_600.0),
                Q::constant(-1.0 / 3_628_800.0),
                Q::constant(1.0 / 40_320.0),
                Q::constant(-1.0 / 720.0),
                Q::constant(1.0 / 24.0),
                Q::constant(-0.5),
                Q::constant(1.0),
            ]
        },
    )
}

/// sin h / h for h from 0 to π/2: its series up to h¹⁴, which leaves 4e-12.
#[inline]
pub fn sine_per_angle<M: Multiply>(h_squared: Q<M, 29>) -> Q<M, 30> {
    horner(
        h_squared,
        const {
            [
                Q::constant(-1.0 / 1_307_674_368_000.0),
                Q::constant(1.0 / 6_227_020_800.0),
                Q::constant(-1.0 / 39_916_800.0),
                Q::constant(1.0 / 362_880.0),
                Q::constant(-1.0 / 5_040.0),
                Q::constant(1.0 / 120.0),
                Q::constant(-1.0 / 6.0),
                Q::constant(1.0),
            ]
        },
    )
}

/// A polynomial, highest power first, by Horner's scheme; no step may leave the coefficients' range.
#[inline(always)]
pub fn horner<M: Multiply, const X: u32, const C: u32, const TERMS: usize>(
    x: Q<M, X>,
    coefficients: [Q<M, C>; TERMS],
) -> Q<M, C> {
    let Some((&first, others)) = coefficients.split_first() else {
        return Q::ZERO;
    };
    others.iter().fold(first, |sum, &c| {
        if X == 32 {
            return Q::from_bits(M::add_high(c.bits(), x.bits(), sum.bits()));
        }
        c + Q::from_bits(M::high(x.bits(), sum.bits()) << (32 - X))
    })
}
