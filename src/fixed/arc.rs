//! Series for the angles of the tilt correction.

use super::multiply::{Multiply, Portable};
use super::number::Q;

/// arctan(r)/r for r² up to 1: above 0.785, to 1. Relative error 1.1e-7: the minimax polynomial of degree 7 in
/// r² that is exact at 0, by Remez' exchange. As Q30, highest power first.
pub const ARC_TANGENT_PER_RATIO: [i32; 8] = {
    const fn q30(value: f64) -> i32 {
        Q::<Portable, 30>::constant(value).bits()
    }
    [
        q30(-0.004_822_535_4),
        q30(0.024_734_067_1),
        q30(-0.060_203_135_1),
        q30(0.099_684_734_1),
        q30(-0.140_413_278_6),
        q30(0.199_742_141_1),
        q30(-0.333_323_916_0),
        q30(1.0),
    ]
};

/// cos h for h from 0 to π/2: its series up to h¹⁴, which leaves 7e-11.
#[inline]
pub fn cosine<M: Multiply>(h_squared: Q<M, 29>) -> Q<M, 30> {
    horner(
        h_squared,
        [
            Q::constant(-1.0 / 87_178_291_200.0),
            Q::constant(1.0 / 479_001_600.0),
            Q::constant(-1.0 / 3_628_800.0),
            Q::constant(1.0 / 40_320.0),
            Q::constant(-1.0 / 720.0),
            Q::constant(1.0 / 24.0),
            Q::constant(-0.5),
            Q::constant(1.0),
        ],
    )
}

/// sin h / h for h from 0 to π/2: its series up to h¹⁴, which leaves 4e-12.
#[inline]
pub fn sine_per_angle<M: Multiply>(h_squared: Q<M, 29>) -> Q<M, 30> {
    horner(
        h_squared,
        [
            Q::constant(-1.0 / 1_307_674_368_000.0),
            Q::constant(1.0 / 6_227_020_800.0),
            Q::constant(-1.0 / 39_916_800.0),
            Q::constant(1.0 / 362_880.0),
            Q::constant(-1.0 / 5_040.0),
            Q::constant(1.0 / 120.0),
            Q::constant(-1.0 / 6.0),
            Q::constant(1.0),
        ],
    )
}

/// A polynomial, highest power first, by Horner's scheme; no step may leave the coefficients' range.
#[inline(always)]
pub fn horner<M: Multiply, const X: u32, const C: u32>(
    x: Q<M, X>,
    coefficients: [Q<M, C>; 8],
) -> Q<M, C> {
    let [c7, c6, c5, c4, c3, c2, c1, c0] = coefficients;
    let step =
        |sum: Q<M, C>, c: Q<M, C>| c + Q::from_bits(M::high(x.bits(), sum.bits()) << (32 - X));
    [c6, c5, c4, c3, c2, c1, c0].into_iter().fold(c7, step)
}
