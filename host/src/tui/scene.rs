//! What is seen: lines and marks in normalised device coordinates, −1 to 1 to the right and up.
//!
//! Everything is taken there by v_clip = M_proj M_view M_model v with the library's matrices; lengths
//! are millimetres.

pub mod board;

pub mod room;

use nalgebra::{Isometry3, Matrix4, Point3, Vector4};
use vrduino::orientation::euler::to_clip_space;
use vrduino::units::{Angle, Millimetres};
use vrduino::view::ViewError;
use vrduino::view::projection::{Depth, Projection};

/// What a line belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// The board's edges, and other things.
    Thing,
    /// What is on the board.
    Part,
    /// The board's axis to the right.
    X,
    /// The board's axis upwards.
    Y,
    /// The board's axis towards the wearer.
    Z,
    /// What does not move.
    Ground,
}

/// Lines, and words at their ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// From, to.
    pub lines: Vec<(Ink, [[f64; 2]; 2])>,
    /// Where, what.
    pub marks: Vec<(Ink, [f64; 2], String)>,
}

impl Picture {
    fn line(&mut self, ink: Ink, ends: Option<[[f64; 2]; 2]>) {
        self.lines.extend(ends.map(|ends| (ink, ends)));
    }

    fn mark(&mut self, ink: Ink, at: Option<[f64; 2]>, text: impl Into<String>) {
        self.marks.extend(at.map(|at| (ink, at, text.into())));
    }
}

/// World to picture.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    view: Matrix4<f64>,
    projection: Matrix4<f64>,
}

/// Nothing nearer is drawn, nor farther.
const DEPTH: Depth<f64> = Depth {
    near: Millimetres(20.0),
    far: Millimetres(20_000.0),
};

impl Camera {
    /// With this whole angle from bottom to top.
    fn new(view: Isometry3<f64>, field_of_view: f64, aspect: f64) -> Result<Self, ViewError> {
        let field_of_view = Angle::from_degrees(field_of_view);
        Ok(Self {
            view: view.to_homogeneous(),
            projection: Projection::straight(field_of_view, aspect, DEPTH)?.matrix(),
        })
    }

    fn clip(&self, model: &Matrix4<f64>, vertex: Point3<f64>) -> Vector4<f64> {
        to_clip_space(&self.projection, &self.view, model, vertex)
    }

    /// A point, if it is in front of the near plane.
    fn point(&self, model: &Matrix4<f64>, vertex: Point3<f64>) -> Option<[f64; 2]> {
        let clip = self.clip(model, vertex);
        (clip.z + clip.w > 0.0).then(|| [clip.x / clip.w, clip.y / clip.w])
    }

    /// The part of a line that is in front of the near plane.
    fn line(&self, model: &Matrix4<f64>, ends: [Point3<f64>; 2]) -> Option<[[f64; 2]; 2]> {
        let [from, to] = ends.map(|end| self.clip(model, end));
        let [before, behind] = [from, to].map(|end| end.z + end.w);
        if before <= 0.0 && behind <= 0.0 {
            return None;
        }
        let cut = |end: Vector4<f64>, other: Vector4<f64>| {
            let (d, e) = (end.z + end.w, other.z + other.w);
            if d > 0.0 {
                end
            } else {
                // A hair before the plane, so that it does not vanish in rounding.
                end + (other - end) * ((d - 1e-9) / (d - e))
            }
        };
        let ends = [cut(from, to), cut(to, from)].map(|clip| [clip.x / clip.w, clip.y / clip.w]);
        ends.iter()
            .flatten()
            .all(|coordinate| coordinate.is_finite())
            .then_some(ends)
    }
}
