//! What a viewer draws with, against cameras worked out from geometry; and algorithms 1 to 3 of the
//! course notes call by call as printed, to show where they go wrong.

mod matrices;

mod random;

#[path = "view/camera.rs"]
mod camera;
#[path = "view/gl.rs"]
mod gl;
#[path = "view/rotations.rs"]
mod rotations;

use camera::Camera;
use gl::{Gl, printed_algorithm_2, printed_algorithm_3};
use nalgebra::{Matrix4, Perspective3, Point3, Quaternion, RealField, UnitQuaternion, Vector3};
use rotations::{Random, apply, axis_angle, larger, product, rotation, transpose};
use std::f64::consts::{FRAC_PI_2, PI};
use vrduino::orientation::quaternion::axis_angle as decomposed;
use vrduino::units::{Angle, Millimetres};
use vrduino::view::eyes::{Eye, InterpupillaryDistance, look_at};
use vrduino::view::gl_rotate::gl_rotate;
use vrduino::view::head_neck::HeadNeck;
use vrduino::view::mounting::Mounting;
use vrduino::view::projection::{Depth, Projection, Window};
use vrduino::view::viewer::Viewer;
use vrduino::view::{ViewError, from_stream, inverse};

const EYES: [(Eye, f64); 2] = [(Eye::Left, -32.0), (Eye::Right, 32.0)];
const INPUTS: usize = 2_000_000;

fn quaternion<T: RealField + Copy>(axis: [f64; 3], angle: f64) -> UnitQuaternion<T> {
    let (sin, cos) = (angle / 2.0).sin_cos();
    let [x, y, z] = axis.map(|component| component * sin);
    from_stream([cos, x, y, z].map(nalgebra::convert)).expect("a rotation")
}

fn broken<T: RealField + Copy>(w_x_y_z: [T; 4]) -> UnitQuaternion<T> {
    let [w, x, y, z] = w_x_y_z;
    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
}

/// The largest difference of a rotation's matrix from the reference.
fn off<T: RealField + Copy>(matrix: &Matrix4<T>, reference: &[[f64; 3]; 3]) -> f64 {
    let number = |x: T| nalgebra::try_convert::<T, f64>(x).expect("a real number");
    let expected = |i: usize, j: usize| match (i, j) {
        (3, 3) => 1.0,
        (3, _) | (_, 3) => 0.0,
        _ => reference[i][j],
    };
    (0..16)
        .map(|k| (number(matrix[(k / 4, k % 4)]) - expected(k / 4, k % 4)).abs())
        .fold(0.0, larger)
}

fn viewer(neck: f64, head: f64) -> Viewer<f64> {
    Viewer {
        mounting: Mounting::Aligned,
        eyes: InterpupillaryDistance::of_the_notes(),
        neck: HeadNeck::new(Millimetres(neck), Millimetres(head)).expect("a neck"),
        position: Point3::origin(),
    }
}

fn seen_by(viewer: &Viewer<f64>, axis: [f64; 3], degrees: f64, eye: Eye) -> Camera {
    let q = quaternion(axis, degrees.to_radians());
    Camera::of(&viewer.view(q, eye).expect("a view").to_homogeneous())
}

#[test]
fn the_test_object_of_algorithm_1_turns_as_the_board_does() {
    fn worst<T: RealField + Copy>() -> f64 {
        let mut random = Random(1);
        (0..INPUTS).fold(0.0, |worst: f64, _| {
            let (axis, angle) = (random.direction(), random.between(-TWO_TURNS, TWO_TURNS));
            let turn = decomposed(quaternion::<T>(axis, angle));
            let found = gl_rotate(turn.angle, turn.axis.into_inner()).expect("finite");
            larger(worst, off(&found, &rotation(axis, angle)))
        })
    }
    const TWO_TURNS: f64 = 4.0 * PI;
    assert!(worst::<f64>() < 1e-9);
    assert!(worst::<f32>() < 1e-5);
}

#[test]
fn radians_given_to_gl_rotate_as_printed_turn_57_times_too_little() {
    let printed = 2.0 * quaternion::<f64>([0.0, 1.0, 0.0], FRAC_PI_2).w.acos();
    let mut gl = Gl::new();
    let drawn = gl.rotate(printed, [0.0, 1.0, 0.0]).draw();
    let turned = drawn[(0, 2)].asin().to_degrees();
    assert!((turned - FRAC_PI_2).abs() < 1e-9, "{turned}° for 90°");

    let q = quaternion::<f64>([0.0, 1.0, 0.0], FRAC_PI_2);
    let found = decomposed(q);
    assert!((found.angle.degrees() - 90.0).abs() < 1e-9);
    let turn = gl_rotate(found.angle, found.axis.into_inner()).expect("finite");
    assert!((turn[(0, 2)] - 1.0).abs() < 1e-12);
}

#[test]
fn a_view_set_after_the_scene_is_rendered_does_not_show() {
    // The text of 5.4.2: “render the scene first, then set the view matrix, then the rotation”.
    let mut gl = Gl::new();
    let as_told = gl.draw();
    gl.look_ahead_from(32.0).rotate(-90.0, [0.0, 1.0, 0.0]);
    assert_eq!(as_told, Matrix4::identity());
    assert!((gl.draw() - as_told).norm() > 1.0);
}

#[test]
fn three_ways_to_the_inverse_agree() {
    fn worst<T: RealField + Copy>() -> f64 {
        let mut random = Random(2);
        (0..INPUTS).fold(0.0, |worst: f64, _| {
            let (axis, angle) = axis_angle(&mut random);
            let (q, expected) = (quaternion::<T>(axis, angle), rotation(axis, -angle));
            let ways = [
                inverse::by_flipped_angle(q),
                inverse::by_conjugate(q),
                inverse::by_matrix(q),
            ];
            let offs = ways.map(|way| off(&way.expect("finite"), &expected));
            offs.into_iter().fold(worst, larger)
        })
    }
    assert!(worst::<f64>() < 1e-9);
    assert!(worst::<f32>() < 1e-5);
}

#[test]
fn a_quaternion_off_the_line_is_of_unit_length_or_refused() {
    let (huge, tiny) = (f32::MAX, f32::from_bits(1));
    for good in [[0.707, 0.0, 0.707, 0.0], [huge; 4], [0.0, tiny, tiny, 0.0]] {
        let q = from_stream(good).expect("has a direction");
        assert!((q.norm() - 1.0).abs() < 1e-6, "{good:?}");
    }
    let nan = f32::NAN;
    for bad in [
        [0.0; 4],
        [nan, 0.0, 0.0, 1.0],
        [1.0, f32::INFINITY, 0.0, 0.0],
    ] {
        assert_eq!(from_stream(bad), Err(ViewError::NotARotation));
        let q = broken(bad);
        let refused = Err(ViewError::NotARotation);
        assert_eq!(inverse::by_flipped_angle(q).map(|_| ()), refused);
        assert_eq!(inverse::by_conjugate(q).map(|_| ()), refused);
        assert_eq!(inverse::by_matrix(q).map(|_| ()), refused);
        assert_eq!(HeadNeck::none().to_head(q).map(|_| ()), refused);
    }
    let up = Vector3::y();
    let turn = |degrees, axis| gl_rotate(Angle::from_degrees(degrees), axis).map(|_| ());
    assert_eq!(turn(90.0_f32, up * tiny), Ok(()));
    assert_eq!(turn(90.0, up * 0.0), Err(ViewError::NoAxis));
    assert_eq!(turn(90.0, up * nan), Err(ViewError::NoAxis));
    assert_eq!(turn(nan, up), Err(ViewError::NoAngle));
}

#[test]
fn a_board_turned_around_is_a_conjugation_not_a_product() {
    let half_turn = rotation([0.0, 1.0, 0.0], PI);
    let mut random = Random(3);
    for _ in 0..INPUTS {
        let (axis, angle) = axis_angle(&mut random);
        // The board's frame is the headset's, turned by F: R_head = Fᵀ R_board F.
        let board = rotation(axis, angle);
        let expected = product(&transpose(&half_turn), &product(&board, &half_turn));
        let head = Mounting::TurnedAround.head(quaternion::<f64>(axis, angle));
        assert!(off(&head.to_homogeneous(), &expected) < 1e-9);
        // The notes' glRotatef(angle, -axisX, axisY, -axisZ).
        let [x, y, z] = axis;
        let flipped = rotation([-x, y, -z], angle);
        assert!(off(&head.to_homogeneous(), &flipped) < 1e-9);
        let by_product = quaternion::<f64>(axis, angle) * broken([0.0, 0.0, 1.0, 0.0]);
        // Wherever the head points, the product has it the wrong way round.
        assert!((by_product.angle_to(&head) - PI).abs() < 1e-6);
        assert_eq!(Mounting::Aligned.head(head), head);
    }
    let rest = UnitQuaternion::<f64>::identity();
    assert_eq!(Mounting::TurnedAround.head(rest), rest);
}

#[test]
fn looking_straight_ahead_from_an_eye_is_a_shift() {
    for (eye, x) in EYES {
        let eyes = InterpupillaryDistance::<f64>::of_the_notes();
        let ahead = look_at(
            Point3::new(x, 0.0, 0.0),
            Point3::new(x, 0.0, -1.0),
            Vector3::y(),
        );
        let (by_look_at, by_shift) = (ahead.expect("a direction"), eyes.from_head(eye));
        let difference = by_look_at.to_homogeneous() - by_shift.to_homogeneous();
        assert!(difference.norm() < 1e-12);
        assert_eq!(by_shift.translation.x, -x);
    }
}

#[test]
fn a_look_at_puts_its_target_ahead_and_up_upwards() {
    let mut random = Random(4);
    for _ in 0..INPUTS {
        let [eye, target, up] = [(); 3].map(|()| Vector3::from(random.vector(100.0)));
        let sight = target - eye;
        if sight.norm() < 1e-3 || sight.cross(&up).norm() < 1e-3 * sight.norm() {
            continue;
        }
        let view = look_at(Point3::from(eye), Point3::from(target), up).expect("a direction");
        assert!((view * Point3::from(eye)).coords.norm() < 1e-9);
        let ahead = view * Point3::from(target);
        assert!((ahead.coords - Vector3::new(0.0, 0.0, -sight.norm())).norm() < 1e-9);
        let up = view * up;
        assert!(up.x.abs() < 1e-9 && up.y > 0.0);
    }
}

#[test]
fn the_eyes_stay_an_interpupillary_distance_apart_along_the_cameras_x() {
    let (mut random, viewer) = (Random(5), viewer(0.0, 0.0));
    for _ in 0..INPUTS {
        let (axis, angle) = axis_angle(&mut random);
        let [left, right] = EYES.map(|(eye, _)| seen_by(&viewer, axis, angle.to_degrees(), eye));
        for (found, expected) in left.baseline_to(&right).into_iter().zip([64.0, 0.0, 0.0]) {
            assert!((found - expected).abs() < 1e-9);
        }
    }
}

#[test]
fn the_eyes_of_algorithm_2_as_printed_change_places_at_a_yaw_of_180_degrees() {
    let up = [0.0, 1.0, 0.0];
    for (yaw, expected) in [(0.0, 64.0), (90.0, 0.0), (180.0, -64.0)] {
        let [left, right] = EYES.map(|(_, x)| printed_algorithm_2(up, yaw, x));
        let baseline = left.baseline_to(&right);
        assert!((baseline[0] - expected).abs() < 1e-9, "{yaw}: {baseline:?}");
        let viewer = viewer(0.0, 0.0);
        let [left, right] = EYES.map(|(eye, _)| seen_by(&viewer, up, yaw, eye));
        assert!((left.baseline_to(&right)[0] - 64.0).abs() < 1e-9);
    }
}

#[test]
fn the_pivot_stays_put_behind_and_below_the_eyes() {
    let (mut random, viewer) = (Random(6), viewer(150.0, 100.0));
    let printed_pivot = [0.0, -150.0, -100.0];
    for _ in 0..INPUTS / 10 {
        let (axis, angle) = axis_angle(&mut random);
        let pivot = viewer.neck.pivot();
        let q = quaternion(axis, angle);
        let moved = viewer.neck.to_head(q).expect("finite") * pivot - pivot;
        assert!(moved.norm() < 1e-9);
        // As printed it is another one, in front of the face.
        let printed = printed_algorithm_3(axis, angle.to_degrees(), 150.0, 100.0, 0.0);
        let seen = printed.sees(printed_pivot);
        assert!((0..3).all(|i| (seen[i] - printed_pivot[i]).abs() < 1e-9));
        // With l_h counted backwards the printed form is right.
        let repaired = printed_algorithm_3(axis, angle.to_degrees(), 150.0, -100.0, 0.0);
        let right = Camera::of(&viewer.neck.to_head(q).expect("finite").to_homogeneous());
        assert!(repaired.off(&right) < 1e-9);
    }
    let pivot = viewer.neck.pivot();
    assert!(pivot.y < 0.0 && pivot.z > 0.0, "looking along -z");
}

#[test]
fn looking_up_moves_the_eyes_back_and_down_and_algorithm_3_as_printed_drops_them() {
    let ahead = [1.0, 0.0, 0.0];
    let viewer = Viewer {
        eyes: InterpupillaryDistance::new(Millimetres(0.0)).expect("one eye"),
        ..viewer(150.0, 100.0)
    };
    let right = seen_by(&viewer, ahead, 90.0, Eye::Left).position();
    let printed = printed_algorithm_3(ahead, 90.0, 150.0, 100.0, 0.0).position();
    for (found, expected) in [(right, [0.0, -50.0, 250.0]), (printed, [0.0, -250.0, 50.0])] {
        assert!(
            (0..3).all(|i| (found[i] - expected[i]).abs() < 1e-9),
            "{found:?}"
        );
    }
    // Leaning the head over to the left moves it to the left and a little down.
    for lean in [0.1, 0.5, 1.2_f64] {
        let leant = seen_by(&viewer, [0.0, 0.0, 1.0], lean.to_degrees(), Eye::Left).position();
        let expected = [-150.0 * lean.sin(), -150.0 * (1.0 - lean.cos()), 0.0];
        assert!(
            (0..3).all(|i| (leant[i] - expected[i]).abs() < 1e-9),
            "{leant:?}"
        );
    }
}

#[test]
fn a_view_is_where_geometry_puts_the_eye() {
    fn worst<T: RealField + Copy>() -> f64 {
        let mut random = Random(7);
        let scalar = |x: f64| -> T { nalgebra::convert(x) };
        (0..INPUTS).fold(0.0, |worst: f64, _| {
            let (axis, angle) = axis_angle(&mut random);
            let [ipd, neck, head] = [80.0, 300.0, 200.0].map(|most| random.between(0.0, most));
            let place = random.vector(1000.0);
            let viewer = Viewer {
                mounting: Mounting::TurnedAround,
                eyes: InterpupillaryDistance::new(Millimetres(scalar(ipd))).expect("in range"),
                neck: HeadNeck::new(Millimetres(scalar(neck)), Millimetres(scalar(head)))
                    .expect("in range"),
                position: Point3::from(place.map(scalar)),
            };
            let [x, y, z] = axis;
            let turn = rotation([-x, y, -z], angle);
            let sides = [(Eye::Left, -ipd / 2.0), (Eye::Right, ipd / 2.0)];
            sides.into_iter().fold(worst, |worst, (eye, side)| {
                // The pivot, and from there to the eye, turned.
                let arm = apply(&turn, [side, neck, -head]);
                let pivot = [place[0], place[1] - neck, place[2] + head];
                let expected = Camera::at([0, 1, 2].map(|i| pivot[i] + arm[i]), &turn);
                let view = viewer.view(quaternion(axis, angle), eye).expect("finite");
                larger(worst, Camera::of(&view.to_homogeneous()).off(&expected))
            })
        })
    }
    // Relative to the lengths, which are of the order of a metre.
    assert!(worst::<f64>() < 1e-9);
    assert!(worst::<f32>() < 1e-5 * 1000.0);
}

#[test]
fn measures_and_places_out_of_range_are_refused() {
    for bad in [-1.0, 1001.0, f32::NAN, f32::INFINITY] {
        let bad = Millimetres(bad);
        assert_eq!(InterpupillaryDistance::new(bad), Err(ViewError::Measure));
        let (good, refused) = (Millimetres(0.0), Err(ViewError::Measure));
        assert_eq!(HeadNeck::new(bad, good), refused);
        assert_eq!(HeadNeck::new(good, bad), refused);
    }
    for bad in [f64::MAX, f64::NAN, f64::NEG_INFINITY] {
        let viewer = Viewer {
            position: Point3::new(bad, bad, bad),
            ..viewer(150.0, 100.0)
        };
        let view = viewer.view(quaternion([0.0, 0.6, 0.8], 1.0), Eye::Left);
        assert_eq!(view.map(|_| ()), Err(ViewError::Position));
    }
    let (o, y) = (Point3::<f64>::origin(), Vector3::y());
    let ahead = Point3::new(0.0, 0.0, -1.0);
    let refused = |eye, target, up| look_at(eye, target, up).expect_err("no such view");
    assert_eq!(refused(o, o, y), ViewError::NoDirection);
    assert_eq!(
        refused(o, Point3::new(0.0, 5.0, 0.0), y),
        ViewError::NoDirection
    );
    assert_eq!(refused(o, ahead, y * 0.0), ViewError::NoDirection);
    assert_eq!(refused(o, ahead, y * f64::NAN), ViewError::NoDirection);
    assert_eq!(refused(o, ahead * f64::NAN, y), ViewError::Position);
}

#[test]
fn a_projection_makes_the_cube_of_what_its_planes_enclose() {
    let [left, right, bottom, top] = [-30.0, 45.0, -20.0, 25.0].map(Millimetres);
    let [near, far] = [50.0, 10_000.0].map(Millimetres);
    let window = Window {
        left,
        right,
        bottom,
        top,
    };
    let projection = Projection::through(window, Depth { near, far }).expect("a volume");
    for (z, depth) in [(near.0, -1.0), (far.0, 1.0)] {
        for (x, side) in [(left.0, -1.0), (right.0, 1.0)] {
            for (y, height) in [(bottom.0, -1.0), (top.0, 1.0)] {
                let corner = Point3::new(x * z / near.0, y * z / near.0, -z);
                let clip = projection.matrix() * corner.to_homogeneous();
                let seen = clip.xyz() / clip.w;
                assert!((seen - Vector3::new(side, height, depth)).norm() < 1e-9);
            }
        }
    }
    let straight =
        Projection::straight(Angle::from_degrees(90.0), 1.25, Depth { near, far }).expect("one");
    let theirs = Perspective3::new(1.25, FRAC_PI_2, near.0, far.0);
    assert!((straight.matrix() - theirs.to_homogeneous()).norm() < 1e-9);
}

#[test]
fn planes_that_enclose_nothing_are_refused() {
    let refused = |degrees: f32, aspect, near, far| {
        let (near, far) = (Millimetres(near), Millimetres(far));
        let projection =
            Projection::straight(Angle::from_degrees(degrees), aspect, Depth { near, far });
        assert_eq!(
            projection,
            Err(ViewError::NoVolume),
            "{degrees} {aspect} {near:?} {far:?}"
        );
    };
    for degrees in [0.0, -90.0, 180.0, 360.0, f32::NAN] {
        refused(degrees, 1.0, 10.0, 1000.0);
    }
    for aspect in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        refused(90.0, aspect, 10.0, 1000.0);
    }
    let planes = [(0.0, 10.0), (-1.0, 10.0), (10.0, 10.0), (10.0, 1.0)];
    for (near, far) in planes
        .into_iter()
        .chain([(f32::NAN, 1.0), (1.0, f32::INFINITY)])
    {
        refused(90.0, 1.0, near, far);
    }
}
