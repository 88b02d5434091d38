//! Series for the angles of the tilt correction.

use super::multiply::{Multiply, Portable};
use super::number::Q;

/// arctan(r)/r for r² up to 1: above 0.785, to 1. Relative error 7.4e-7: the minimax polynomial of degree 6 in
/// r² that is exact at 0, by Remez' exchange. As Q30, highest power first.
pub const ARC_TANGENT_PER_RATIO: [i32; 7] = {
    const fn q30(value: f64) -> i32 {
        Q::<Portable, 30>::constant(value).bits()
    }
    [
        q30(0.008_106_368_1),
        q30(-0.037_796_721_5),
        q30(0.084_841_041_0),
        q30(-0.135_445_762_5),
        q30(0.198_978_733_3),
        q30(-0.333_284_919_5),
        q30(1.0),
    ]
};

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
        c + Q::from_bits(M::high(x.bits(), sum.bits()) << (32 - X))
    })
}
