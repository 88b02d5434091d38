//! How the board sits on the headset (course notes, section 5.4.2, figure 8).

use nalgebra::{Quaternion, RealField, UnitQuaternion};

/// The two ways of figure 8. Both have the board upright; how far it turns about the vertical is
/// all that differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Mounting {
    /// Left: held in front, the board's frame is the headset's.
    #[default]
    Aligned,
    /// Right: taped to the front, turned by 180° about y. The board's x is the headset's −x, its z
    /// the headset's −z.
    TurnedAround,
}

impl Mounting {
    /// The orientation of the head, of which `board` is that of the board. Both are body to world,
    /// and both worlds have the identity for the starting heading.
    ///
    /// With F the half turn about y it is F q F⁻¹ = (w, −x, y, −z), the notes'
    /// `glRotatef(-angle, -axisX, axisY, -axisZ)`: the *axis* is expressed in the headset's frame.
    /// The product q F is off by 180° at every orientation. Signs are all that changes, so what is not
    /// of unit length or not finite stays so; [`super::viewer::Viewer::view`] says so.
    pub fn head<T: RealField + Copy>(self, board: UnitQuaternion<T>) -> UnitQuaternion<T> {
        match self {
            Self::Aligned => board,
            Self::TurnedAround => {
                UnitQuaternion::new_unchecked(Quaternion::new(board.w, -board.i, board.j, -board.k))
            }
        }
    }
}
