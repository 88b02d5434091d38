//! Linear least squares by normal equations, one row at a time and in a fixed amount of memory.

use nalgebra::{Cholesky, RealField, SMatrix, SVector, convert};

/// Σ rᵀr, Σ rᵀy and Σ y² of rows r with targets y.
///
/// Squaring the problem costs half of the digits, so both users pose it in numbers near one, about
/// its own centre, and with a small target: then half of single precision is enough.
#[derive(Clone, Copy, Debug)]
pub(super) struct NormalEquations<T, const N: usize> {
    pub(super) matrix: SMatrix<T, N, N>,
    pub(super) target: SVector<T, N>,
    pub(super) squares: T,
    pub(super) rows: u32,
}

impl<T: RealField + Copy, const N: usize> NormalEquations<T, N> {
    pub(super) fn new() -> Self {
        Self {
            matrix: SMatrix::zeros(),
            target: SVector::zeros(),
            squares: T::zero(),
            rows: 0,
        }
    }

    pub(super) fn add(&mut self, row: &SVector<T, N>, target: T) {
        self.matrix += row * row.transpose();
        self.target += row * target;
        self.squares += target * target;
        self.rows = self.rows.saturating_add(1);
    }

    /// The solution, and the root mean square of what it leaves. None if the rows do not determine
    /// it to a quarter of the scalar's digits, or something is not finite.
    pub(super) fn solve(&self) -> Option<(SVector<T, N>, T)> {
        let factor = Cholesky::new(self.matrix)?;
        let diagonal = factor.l_dirty().diagonal();
        // Squares of the pivots against the diagonal they came from: what was left of each row once
        // those before it were taken out.
        let lost = diagonal
            .iter()
            .zip(self.matrix.diagonal().iter())
            .any(|(pivot, whole)| *pivot * *pivot <= *whole * T::default_epsilon() * convert(64.0));
        let solution = factor.solve(&self.target);
        if lost || !solution.iter().all(|value| value.is_finite()) {
            return None;
        }
        let left = (self.squares - solution.dot(&self.target)).max(T::zero());
        let rows = number::<T>(i64::from(self.rows.max(1)));
        Some((solution, (left / rows).sqrt()))
    }
}

/// A whole number as a scalar, without a detour through double precision.
pub(super) fn number<T: RealField>(whole: i64) -> T {
    T::from_i64(whole).unwrap_or_else(T::zero)
}
