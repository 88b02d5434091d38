//! The board, seen from in front of it (course notes, algorithm 1: a test object turned as the board is).

use nalgebra::{Matrix4, Point3, UnitQuaternion, Vector3};
use vrduino::view::eyes::look_at;

use super::{Camera, Ink, Picture};

/// Half of width, height and thickness (mm).
const HALF: [f64; 3] = [50.0, 32.0, 3.0];

/// Where the viewer stands (mm): a little to the left of the board and above it.
pub const EYE: [f64; 3] = [-160.0, 180.0, 420.0];

/// So many mm to either side of the board's middle, and above and below it, are in the picture.
pub const WITHIN: [f64; 2] = [92.0, 86.0];

/// Ends of the axes (mm), in the frame of the board.
pub const AXES: [(Ink, [f64; 3], &str); 3] = [
    (Ink::X, [80.0, 0.0, 0.0], "X"),
    (Ink::Y, [0.0, 62.0, 0.0], "Y"),
    (Ink::Z, [0.0, 0.0, 66.0], "Z"),
];

/// The circle beneath the board (mm): its radius, and how far down.
const GROUND: (f64, f64) = (62.0, -58.0);

/// The camera, for a picture of this width over its height.
pub fn camera(aspect: f64) -> Option<Camera> {
    let [across, up] = WITHIN;
    let eye = Point3::from(EYE);
    let half = (up.max(across / aspect) / eye.coords.norm()).atan();
    let view = look_at(eye, Point3::origin(), Vector3::y()).ok()?;
    Camera::new(view, 2.0 * half.to_degrees(), aspect).ok()
}

/// The picture, for an orientation from body to world.
pub fn picture(orientation: UnitQuaternion<f64>, aspect: f64) -> Picture {
    let mut picture = Picture::default();
    let Some(camera) = camera(aspect) else {
        return picture;
    };
    ground(&camera, &mut picture);
    let model = orientation.to_homogeneous();
    let eye = orientation.inverse() * Point3::from(EYE);
    // Of a box one sees the faces that are turned to the eye.
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            if side * eye[axis] > HALF[axis] {
                for ends in edges(axis, side) {
                    picture.line(Ink::Thing, camera.line(&model, ends));
                }
            }
        }
    }
    if eye.z > HALF[2] {
        front(&camera, &model, &mut picture);
    } else if eye.z < -HALF[2] {
        back(&camera, &model, &mut picture);
    }
    for (ink, end, name) in AXES {
        let end = Point3::from(end);
        picture.line(ink, camera.line(&model, [Point3::origin(), end]));
        picture.mark(ink, camera.point(&model, end), name);
    }
    picture
}

/// The four edges of a face.
fn edges(axis: usize, side: f64) -> [[Point3<f64>; 2]; 4] {
    let corner = |a: f64, b: f64| {
        let mut point = Point3::origin();
        point[axis] = side * HALF[axis];
        point[(axis + 1) % 3] = a * HALF[(axis + 1) % 3];
        point[(axis + 2) % 3] = b * HALF[(axis + 2) % 3];
        point
    };
    let corners = [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    [0, 1, 2, 3].map(|i| [corners[i], corners[(i + 1) % 4]])
}

/// The Teensy with its plug, the sensor, and the photodiodes in the corners.
fn front(camera: &Camera, model: &Matrix4<f64>, picture: &mut Picture) {
    let mut rectangle = |[x, y]: [f64; 2], [w, h]: [f64; 2]| {
        let z = HALF[2];
        let corners = [[x, y], [x + w, y], [x + w, y + h], [x, y + h]];
        let corners = corners.map(|[x, y]| Point3::new(x, y, z));
        for i in 0..4 {
            let ends = [corners[i], corners[(i + 1) % 4]];
            picture.line(Ink::Part, camera.line(model, ends));
        }
    };
    rectangle([-9.0, -12.0], [18.0, 36.0]);
    rectangle([-4.0, 24.0], [8.0, 8.0]);
    rectangle([-5.0, -26.0], [10.0, 8.0]);
    for [x, y] in [[-46.0, -28.0], [40.0, -28.0], [40.0, 22.0], [-46.0, 22.0]] {
        rectangle([x, y], [6.0, 6.0]);
    }
}

/// A cross, so that nobody takes it for the front.
fn back(camera: &Camera, model: &Matrix4<f64>, picture: &mut Picture) {
    let [x, y, z] = HALF;
    for side in [-1.0, 1.0] {
        let ends = [Point3::new(-x, -side * y, -z), Point3::new(x, side * y, -z)];
        picture.line(Ink::Part, camera.line(model, ends));
    }
}

/// A circle in the world, and on which side of it the wearer is.
fn ground(camera: &Camera, picture: &mut Picture) {
    const PIECES: usize = 48;
    let (radius, y) = GROUND;
    let model = Matrix4::identity();
    let at = |i: usize, radius: f64| {
        let angle = i as f64 / PIECES as f64 * std::f64::consts::TAU;
        Point3::new(-radius * angle.sin(), y, -radius * angle.cos())
    };
    for i in 0..PIECES {
        picture.line(
            Ink::Ground,
            camera.line(&model, [at(i, radius), at(i + 1, radius)]),
        );
    }
    // A mark every 30°, a long one towards the wearer.
    for i in (0..PIECES).step_by(PIECES / 12) {
        let inner = radius * if i == PIECES / 2 { 0.5 } else { 0.88 };
        picture.line(
            Ink::Ground,
            camera.line(&model, [at(i, inner), at(i, radius)]),
        );
    }
    picture.mark(
        Ink::Ground,
        camera.point(&model, at(PIECES / 2, 1.12 * radius)),
        "wearer",
    );
}
