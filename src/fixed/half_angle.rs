//! Small rotations without trigonometric functions: (cos h, n sin h) with h = φ/2 is the unit quaternion of a
//! turn by φ about n, and (1, n tan h) the same but for its length.

use super::multiply::Multiply;
use super::number::Q;

/// How much longer tan h is than h = φ/2: tan h / h − 1 = h²/3 + 2h⁴/15 + …, for |h| up to 0.33.
///
/// What is left out is 17h⁷/315: of h = 0.03, 2000 °/s about all three axes for a millisecond, 1e-12.
#[inline(always)]
pub fn tangent_excess<M: Multiply>(h_squared: Q<M, 32>) -> Q<M, 32> {
    let third = const { Q::<M, 32>::constant(1.0 / 3.0) };
    let next = const { Q::<M, 32>::constant(2.0 / 15.0) };
    Q::product(h_squared, third.plus(h_squared, next))
}

/// 1 + tan²h, the square of the length of (1, t): 1 + h² + 2h⁴/3 + …
///
/// What is left out is 17h⁶/45: of h = 0.03, 3e-10.
#[inline(always)]
pub fn length_squared<M: Multiply>(h_squared: Q<M, 32>) -> Q<M, 27> {
    let one = const { Q::<M, 27>::constant(1.0) };
    let next = const { Q::<M, 27>::constant(2.0 / 3.0) };
    one.plus(h_squared, one.plus(h_squared, next))
}

/// How much shorter sin h is than h: sin h / h − 1 = −h²/6 + h⁴/120 − …, for |h| up to 0.33.
///
/// What is left out is h⁷/5040: of h = 0.03, 4e-15.
#[inline(always)]
pub fn sine_excess<M: Multiply>(h_squared: Q<M, 32>) -> Q<M, 32> {
    let sixth = const { Q::<M, 32>::constant(-1.0 / 6.0) };
    let next = const { Q::<M, 32>::constant(1.0 / 120.0) };
    Q::product(h_squared, sixth.plus(h_squared, next))
}

/// cos h − 1 = −h²/2 + h⁴/24 − …; leaves h⁶/720.
#[inline(always)]
pub fn cosine_excess<M: Multiply>(h_squared: Q<M, 32>) -> Q<M, 32> {
    let half = const { Q::<M, 32>::constant(-0.5) };
    let next = const { Q::<M, 32>::constant(1.0 / 24.0) };
    Q::product(h_squared, half.plus(h_squared, next))
}
