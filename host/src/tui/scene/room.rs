//! A room, seen through a headset (course notes, algorithms 2 and 3).
//!
//! There is something to be seen wherever the head turns: columns all round, with the heading at which
//! they stand, a floor, and a cube near enough for two eyes to see it at two places.

use nalgebra::{Matrix4, Point3, UnitQuaternion};
use vrduino::view::eyes::Eye;
use vrduino::view::viewer::Viewer;

use super::{Camera, Ink, Picture};

/// Whole angle (°) from bottom to top, and from side to side, that is seen at least.
const FIELD_OF_VIEW: [f64; 2] = [60.0, 70.0];

/// How far off the columns stand, and how high they are (mm).
const COLUMNS: (f64, f64) = (2600.0, 1650.0);

/// Middle of the cube, and half its edge (mm).
const CUBE: ([f64; 3], f64) = ([0.0, 1130.0, -900.0], 110.0);

/// The picture of one eye, for the board's orientation from body to world.
pub fn picture(
    viewer: &Viewer<f64>,
    orientation: UnitQuaternion<f64>,
    eye: Eye,
    aspect: f64,
) -> Picture {
    let mut picture = Picture::default();
    let Ok(view) = viewer.view(orientation, eye) else {
        return picture;
    };
    let Ok(camera) = Camera::new(view, field_of_view(aspect), aspect) else {
        return picture;
    };
    floor(&camera, &mut picture);
    columns(&camera, &mut picture);
    cube(&camera, &mut picture);
    picture
}

/// From bottom to top (°), for a picture of this width over its height.
fn field_of_view(aspect: f64) -> f64 {
    let [up, across] = FIELD_OF_VIEW.map(|angle| (angle / 2.0).to_radians().tan());
    2.0 * up.max(across / aspect).atan().to_degrees()
}

fn floor(camera: &Camera, picture: &mut Picture) {
    const END: f64 = 3000.0;
    let model = Matrix4::identity();
    for i in -3..=3 {
        let at = f64::from(i) * 1000.0;
        let along = [Point3::new(at, 0.0, -END), Point3::new(at, 0.0, END)];
        let across = [Point3::new(-END, 0.0, at), Point3::new(END, 0.0, at)];
        for ends in [along, across] {
            picture.line(Ink::Ground, camera.line(&model, ends));
        }
    }
}

fn columns(camera: &Camera, picture: &mut Picture) {
    let (distance, height) = COLUMNS;
    let model = Matrix4::identity();
    for heading in (-150..=180).step_by(30) {
        let (sin, cos) = f64::from(heading).to_radians().sin_cos();
        // To the left is positive, as yaw is.
        let at = |y: f64| Point3::new(-distance * sin, y, -distance * cos);
        picture.line(Ink::Part, camera.line(&model, [at(0.0), at(height)]));
        picture.mark(
            Ink::Part,
            camera.point(&model, at(height + 60.0)),
            format!("{heading}°"),
        );
    }
}

fn cube(camera: &Camera, picture: &mut Picture) {
    let (middle, half) = CUBE;
    let model = Matrix4::new_translation(&middle.into());
    let corner = |i: usize| {
        let side = |bit: usize| if i >> bit & 1 == 0 { -half } else { half };
        Point3::new(side(0), side(1), side(2))
    };
    for i in 0..8 {
        for bit in 0..3 {
            if i >> bit & 1 == 0 {
                let ends = [corner(i), corner(i | 1 << bit)];
                picture.line(Ink::Thing, camera.line(&model, ends));
            }
        }
    }
    for (axis, ink) in [Ink::X, Ink::Y, Ink::Z].into_iter().enumerate() {
        let mut end = Point3::origin();
        end[axis] = 1.8 * half;
        picture.line(ink, camera.line(&model, [Point3::origin(), end]));
        picture.mark(ink, camera.point(&model, end), ["X", "Y", "Z"][axis]);
    }
}
