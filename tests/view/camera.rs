//! Cameras as plain arrays in double precision.

use crate::rotations::{Matrix, Vector, apply, larger, transpose};
use nalgebra::{Matrix4, RealField};

/// A camera by its view matrix: what it turns by, and what it then shifts by.
pub struct Camera {
    turn: Matrix,
    shift: Vector,
}

impl Camera {
    /// Of a 4×4 view matrix, world to camera, which has to be rigid in its last row.
    pub fn of<T: RealField + Copy>(view: &Matrix4<T>) -> Self {
        let at = |i, j| nalgebra::try_convert::<T, f64>(view[(i, j)]).expect("a real number");
        assert_eq!([0, 1, 2, 3].map(|j| at(3, j)), [0.0, 0.0, 0.0, 1.0]);
        Self {
            turn: [0, 1, 2].map(|i| [0, 1, 2].map(|j| at(i, j))),
            shift: [0, 1, 2].map(|i| at(i, 3)),
        }
    }

    /// Standing at `position`, turned by `turn` (camera to world).
    pub fn at(position: Vector, turn: &Matrix) -> Self {
        let turn = transpose(turn);
        Self {
            shift: apply(&turn, position).map(|x| -x),
            turn,
        }
    }

    /// Where it stands in the world.
    pub fn position(&self) -> Vector {
        apply(&transpose(&self.turn), self.shift).map(|x| -x)
    }

    /// A point of the world in this camera's frame.
    pub fn sees(&self, point: Vector) -> Vector {
        let turned = apply(&self.turn, point);
        [0, 1, 2].map(|i| turned[i] + self.shift[i])
    }

    /// From here to the other camera, in this one's frame.
    pub fn baseline_to(&self, other: &Self) -> Vector {
        self.sees(other.position())
    }

    /// The largest difference between the two view matrices.
    pub fn off(&self, other: &Self) -> f64 {
        let turns = self.turn.iter().flatten().zip(other.turn.iter().flatten());
        let pairs = turns.chain(self.shift.iter().zip(&other.shift));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, larger)
    }
}
