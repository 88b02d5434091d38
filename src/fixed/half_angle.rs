//! Small rotations without trigonometric functions: (1, t) with t = n tan(φ/2) is the unit quaternion of a
//! turn by φ about n, but for its length.

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
