//! The ellipsoid that best fits a cloud of points, in closed form.

use super::least_squares::{NormalEquations, number};
use super::moments::{LARGEST, Moments};
use nalgebra::{Matrix3, RealField, SVector, Vector3, convert, convert_unchecked};

/// An ellipsoid |W (x − c)| = 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ellipsoid<T: RealField + Copy> {
    /// c, in the unit of the points.
    pub(super) centre: Vector3<T>,
    /// W, symmetric and positive definite, one over that unit.
    pub(super) to_unit_sphere: Matrix3<T>,
    /// Root mean square of |W (x − c)| − 1 over the points.
    pub(super) rms: T,
    /// Longest semi-axis over shortest.
    pub(super) axis_ratio: T,
}

/// A coefficient and the powers of x, y, z.
type Term = (i8, [usize; 3]);

/// What the nine unknowns stand before. Q = I + U has the trace 3 by construction: that excludes the
/// zero solution and, unlike a fixed constant term, does not care where the origin is.
const FEATURES: [&[Term]; 9] = [
    &[(1, [2, 0, 0]), (-1, [0, 0, 2])],
    &[(1, [0, 2, 0]), (-1, [0, 0, 2])],
    &[(2, [1, 1, 0])],
    &[(2, [1, 0, 1])],
    &[(2, [0, 1, 1])],
    &[(2, [1, 0, 0])],
    &[(2, [0, 1, 0])],
    &[(2, [0, 0, 1])],
    &[(1, [0, 0, 0])],
];

/// What they should add up to: 1 − |x|², small for points near the unit sphere.
const TARGET: &[Term] = &[
    (1, [0, 0, 0]),
    (-1, [2, 0, 0]),
    (-1, [0, 2, 0]),
    (-1, [0, 0, 2]),
];

/// Fits are repeated about the centre just found: the first is about the points' mean, which lies
/// off the centre when they are on one side of it.
const REPEATS: usize = 4;

/// Fits xᵀQx + 2 l·x + k = 0 in the least squares of that expression. None if the points do not
/// determine it, if it is no ellipsoid, or if its centre is further than [`LARGEST`] from the origin.
pub(super) fn fit<T: RealField + Copy>(moments: &Moments) -> Option<Ellipsoid<T>> {
    let mut origin = mean::<T>(moments)?;
    let mut found = None;
    for _ in 0..REPEATS {
        let whole = nearest_whole(origin)?;
        let ellipsoid = fit_about(&moments.about(whole), whole)?;
        let moved = (ellipsoid.centre - origin).amax();
        origin = ellipsoid.centre;
        found = Some(ellipsoid);
        if moved < T::one() {
            break;
        }
    }
    found
}

/// The points' variances along the three directions in which they are spread most to least, in the
/// square of their unit, largest first.
pub(super) fn spread<T: RealField + Copy>(moments: &Moments) -> Option<[T; 3]> {
    let whole = nearest_whole(mean::<T>(moments)?)?;
    let (variances, _) = eigen(second_moments(&moments.about(whole)))?;
    let mut sorted: [T; 3] = variances.into();
    sorted.sort_unstable_by(|a, b| b.partial_cmp(a).unwrap_or(core::cmp::Ordering::Equal));
    Some(sorted)
}

/// The variance along each axis, in the square of the points' unit.
pub(super) fn variances<T: RealField + Copy>(moments: &Moments) -> Option<Vector3<T>> {
    let whole = nearest_whole(mean::<T>(moments)?)?;
    Some(second_moments(&moments.about(whole)).diagonal())
}

fn mean<T: RealField + Copy>(moments: &Moments) -> Option<Vector3<T>> {
    let sums = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|[i, j, k]| moments.sum(i, j, k));
    let count = moments.count();
    (count > 0).then(|| Vector3::from(sums.map(number::<T>)) / number::<T>(count))
}

fn second_moments<T: RealField + Copy>(moments: &Moments) -> Matrix3<T> {
    let count = number::<T>(moments.count());
    Matrix3::from_fn(|row, column| {
        let mut powers = [0; 3];
        powers[row] += 1;
        powers[column] += 1;
        let [i, j, k] = powers;
        number::<T>(moments.sum(i, j, k)) / count
    })
}

/// None if it is beyond what moments can be taken about.
fn nearest_whole<T: RealField + Copy>(point: Vector3<T>) -> Option<[i32; 3]> {
    // To a single-precision number, which holds every such whole number.
    let whole = point.map(|value| convert_unchecked::<T, f32>(value.round()) as i32);
    let finite = point.iter().all(|value| value.is_finite());
    (finite && whole.iter().all(|value| value.abs() <= LARGEST)).then(|| whole.into())
}

fn fit_about<T: RealField + Copy>(moments: &Moments, origin: [i32; 3]) -> Option<Ellipsoid<T>> {
    let size = second_moments::<T>(moments).trace().sqrt();
    if size <= T::zero() {
        return None;
    }
    let (theta, rms) = normal_equations(moments, size).solve()?;
    let one = T::one();
    let [a, b, xy, xz, yz, lx, ly, lz, constant] = theta.into();
    let q = Matrix3::new(
        one + a,
        xy,
        xz,
        xy,
        one + b,
        yz,
        xz,
        yz,
        one - a - b, //
    );
    let centre = -(q.cholesky()?.solve(&Vector3::new(lx, ly, lz)));
    // (x − c)ᵀ Q (x − c) = cᵀ Q c − k, and k = constant − 1 by the choice of the target.
    let level = centre.dot(&(q * centre)) - constant + one;
    let (squares, axes) = eigen(q / level)?;
    if level <= T::zero() || squares.min() <= T::zero() {
        return None;
    }
    let to_unit_sphere =
        axes * Matrix3::from_diagonal(&squares.map(|s| s.sqrt())) * axes.transpose();
    // Symmetric to the last digit, as it is kept.
    let to_unit_sphere = (to_unit_sphere + to_unit_sphere.transpose()) * convert::<f64, T>(0.5);
    let ellipsoid = Ellipsoid {
        centre: Vector3::from(origin.map(|c| number::<T>(i64::from(c)))) + centre * size,
        to_unit_sphere: to_unit_sphere / size,
        // A radius that is off by δ has a square that is off by 2δ.
        rms: rms / (level * convert(2.0)),
        axis_ratio: (squares.max() / squares.min()).sqrt(),
    };
    let finite = ellipsoid.centre.iter().all(|value| value.is_finite())
        && to_unit_sphere.iter().all(|value| value.is_finite());
    finite.then_some(ellipsoid)
}

/// Of points divided by `size`, each with the weight one over their number.
fn normal_equations<T: RealField + Copy>(moments: &Moments, size: T) -> NormalEquations<T, 9> {
    let count = number::<T>(moments.count());
    let product = |left: &[Term], right: &[Term]| {
        let mut sum = T::zero();
        for (a, [i, j, k]) in left {
            for (b, [l, m, n]) in right {
                let degree = i + j + k + l + m + n;
                let moment = number::<T>(moments.sum(i + l, j + m, k + n));
                let factor = number::<T>(i64::from(*a) * i64::from(*b));
                sum += moment * factor / (count * power(size, degree));
            }
        }
        sum
    };
    NormalEquations {
        matrix: nalgebra::SMatrix::from_fn(|i, j| product(FEATURES[i], FEATURES[j])),
        target: SVector::from_fn(|i, _| product(FEATURES[i], TARGET)),
        squares: product(TARGET, TARGET),
        rows: 1,
    }
}

fn power<T: RealField + Copy>(base: T, exponent: usize) -> T {
    (0..exponent).fold(T::one(), |product, _| product * base)
}

/// Eigenvalues and eigenvectors of a symmetric matrix; none if it is not finite.
fn eigen<T: RealField + Copy>(symmetric: Matrix3<T>) -> Option<(Vector3<T>, Matrix3<T>)> {
    if !symmetric.iter().all(|value| value.is_finite()) {
        return None;
    }
    // Three to six rotations do; the bound is for what should not happen.
    let eigen = symmetric.try_symmetric_eigen(T::default_epsilon(), 100)?;
    Some((eigen.eigenvalues, eigen.eigenvectors))
}
