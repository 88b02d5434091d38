//! Table 2 as printed beside the quaternion of the matrix.

use crate::reference::*;
use nalgebra::{Matrix3, RealField, Rotation3, convert};
use std::f64::consts::FRAC_PI_2;
use vrduino::virtual_gyro::attitude_quaternion::from_matrix;

fn rotation<T: RealField + Copy>(m: &Matrix) -> Rotation3<T> {
    Rotation3::from_matrix_unchecked(Matrix3::from_fn(|i, j| convert(m[i][j])))
}

/// q, device to reference, against M, reference to device.
fn error<T: RealField + Copy>(m: &Matrix) -> f64 {
    let q = scalar_last(&from_matrix::<T>(&rotation(m)).expect("a rotation"));
    let length: f64 = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    largest_difference(&transpose(&sandwich(q)), m).max((length - 1.0).abs())
}

/// Attitudes, half turns about every kind of axis, and the corners between the cases.
fn matrices() -> impl Iterator<Item = Matrix> {
    let mut random = Random(1);
    let anywhere = (0..2_000_000).map(move |k| {
        let axis = random.vector(1.0);
        let length = axis.iter().map(|c| c * c).sum::<f64>().sqrt();
        let axis = axis.map(|c| c / length);
        match k % 4 {
            0 => about(axis, std::f64::consts::PI),
            1 => about(axis, std::f64::consts::PI - random.between(-1e-6, 1e-6)),
            _ => about(axis, random.between(-7.0, 7.0)),
        }
    });
    let sign = |k: u32, bit: u32| if k >> bit & 1 == 0 { 0.5 } else { -0.5 };
    let equal = (0..16).map(move |k| sandwich([sign(k, 0), sign(k, 1), sign(k, 2), sign(k, 3)]));
    let (s, o) = (0.5_f64.sqrt(), 0.0);
    let two = [
        [s, s, o, o],
        [s, o, s, o],
        [s, o, o, s],
        [o, s, s, o],
        [o, s, o, s],
        [o, o, s, s],
    ];
    let one = [
        [1.0, o, o, o],
        [o, 1.0, o, o],
        [o, o, 1.0, o],
        [o, o, o, 1.0],
    ];
    anywhere
        .chain(equal)
        .chain(two.into_iter().chain(one).map(sandwich))
}

#[test]
fn every_matrix_has_its_quaternion() {
    let worst = matrices().map(|m| error::<f64>(&m)).fold(0.0, larger);
    assert!(worst < 1e-14 * 10.0, "{worst:e}");
    let worst = matrices().map(|m| error::<f32>(&m)).fold(0.0, larger);
    assert!(worst < 1e-6, "{worst:e}");
}

#[test]
fn what_is_no_rotation_matrix_has_no_quaternion_or_a_unit_one() {
    for bad in [f64::NAN, f64::INFINITY, 1e300, -3.0] {
        for i in 0..9 {
            let mut m = r([0.3, -0.4, 1.1]);
            m[i / 3][i % 3] = bad;
            assert_eq!(from_matrix::<f64>(&rotation(&m)), None);
        }
    }
    let mut random = Random(2);
    for _ in 0..2_000_000 {
        let m = [(); 3].map(|()| random.vector(2.0));
        let q = from_matrix::<f64>(&rotation(&m)).expect("finite");
        assert!((q.norm() - 1.0).abs() < 1e-12);
    }
}

/// The three conditions of each case, as printed.
fn printed_conditions(m: &Matrix) -> [bool; 4] {
    let (m11, m22, m33) = (m[0][0], m[1][1], m[2][2]);
    [
        m22 < -m33 && m11 > m22 && m11 > m33,
        m22 > m33 && m11 < -m22 && m11 < -m33,
        m22 < m33 && m11 < -m22 && m11 > m33,
        m22 > -m33 && m11 > -m22 && m11 > -m33,
    ]
}

/// With the second condition of case 2 and the third of case 3 put right.
fn corrected_conditions(m: &Matrix) -> [bool; 4] {
    let (m11, m22, m33) = (m[0][0], m[1][1], m[2][2]);
    let [first, _, _, fourth] = printed_conditions(m);
    [
        first,
        m22 > m33 && m11 < m22 && m11 < -m33,
        m22 < m33 && m11 < -m22 && m11 < m33,
        fourth,
    ]
}

/// How many cases each of 100,000 matrices meets: none, one, several.
fn counts(conditions: fn(&Matrix) -> [bool; 4]) -> [usize; 3] {
    let mut random = Random(3);
    let mut counts = [0; 3];
    for _ in 0..100_000 {
        // Uniform over the rotations: a normalised vector from within the unit ball of four.
        let q = loop {
            let q = [(); 4].map(|()| random.between(-1.0, 1.0));
            let n: f64 = q.iter().map(|c| c * c).sum();
            if n <= 1.0 && n > 1e-3 {
                break q.map(|c| c / n.sqrt());
            }
        };
        let met = conditions(&sandwich(q)).iter().filter(|met| **met).count();
        counts[met.min(2)] += 1;
    }
    counts
}

#[test]
fn the_printed_conditions_leave_a_third_of_all_matrices_without_a_case() {
    let [none, one, several] = counts(printed_conditions).map(|n| n as f64 / 1000.0);
    eprintln!("printed: none {none} %, one {one} %, several {several} %");
    assert!((none - 37.0).abs() < 2.0 && (one - 50.0).abs() < 2.0 && (several - 12.0).abs() < 2.0);
    assert_eq!(counts(corrected_conditions), [0, 100_000, 0]);
}

#[test]
fn half_turns_about_y_and_z_match_no_printed_case_and_equal_components_no_strict_one() {
    for q in [[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] {
        assert_eq!(printed_conditions(&sandwich(q)), [false; 4]);
        assert!(error::<f64>(&sandwich(q)) < 1e-15);
    }
    let equal = sandwich([0.5; 4]);
    assert_eq!(corrected_conditions(&equal), [false; 4]);
    assert!(error::<f64>(&equal) < 1e-15);
}

#[test]
fn the_printed_roots_do_not_give_unit_quaternions() {
    let length = |q: [f64; 4]| q.iter().map(|c| c * c).sum::<f64>().sqrt();
    // Case 4 at (.3, −.4, 1.1): divided by the root of case 1.
    let m = r([0.3, -0.4, 1.1]);
    let (own, printed) = (
        (1.0 + m[0][0] + m[1][1] + m[2][2]).sqrt(),
        (1.0 + m[0][0] - m[1][1] - m[2][2]).sqrt(),
    );
    let case_4 = |root: f64| {
        [
            (m[1][2] - m[2][1]) / root,
            (m[2][0] - m[0][2]) / root,
            (m[0][1] - m[1][0]) / root,
            own,
        ]
        .map(|c| c / 2.0)
    };
    assert!((length(case_4(printed)) - 2.238).abs() < 1e-3);
    assert!((length(case_4(own)) - 1.0).abs() < 1e-12);
    // Case 2 at 150° about y: its own root, printed with the wrong sign of M22.
    let m = ry(5.0 / 3.0 * FRAC_PI_2);
    let (m11, m22, m33) = (m[0][0], m[1][1], m[2][2]);
    assert!((1.0 - m11 - m22 - m33 - 1.73).abs() < 5e-3);
    assert!((1.0 - m11 + m22 - m33 - 3.73).abs() < 5e-3);
    assert!(error::<f64>(&m) < 1e-15);
}
