//! The metric against another formulation, and what is made of files that are not as they should be.

#[path = "../../tests/matrices/mod.rs"]
mod matrices;
#[path = "../../tests/random/mod.rs"]
mod random;
#[path = "recording/mod.rs"]
mod recording;

use matrices::{Matrix, apply, product, transpose};
use nalgebra::{UnitQuaternion, Vector3};
use random::Random;
use recording::{Bytes, folder};
use vrduino_accuracy::score::Score;
use vrduino_accuracy::trial::Trial;
use vrduino_accuracy::variant::Variant;
use vrduino_accuracy::{estimators, evaluation};

fn matrix(q: &UnitQuaternion<f64>) -> Matrix {
    let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| q * axis);
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| columns[column][row]))
}

/// Inclination, heading and total of e = R R_refᵀ in degrees: the angle between up and up, the turn
/// about y that is left once up is turned to up, and the angle of the trace.
fn by_matrices(found: &UnitQuaternion<f64>, truth: &UnitQuaternion<f64>) -> [f64; 3] {
    let e = product(&matrix(found), &transpose(&matrix(truth)));
    let up = apply(&e, [0.0, 1.0, 0.0]);
    let inclination = up[0].hypot(up[2]).atan2(up[1]);
    // Swing and twist: the twist about y of a rotation matrix.
    let heading = (e[0][2] - e[2][0]).atan2(e[0][0] + e[2][2]);
    let total = ((e[0][0] + e[1][1] + e[2][2] - 1.0) / 2.0)
        .clamp(-1.0, 1.0)
        .acos();
    [inclination, heading, total].map(f64::to_degrees)
}

fn rotation(random: &mut Random) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(Vector3::from(random.vector(2.0)))
}

#[test]
fn the_metric_is_that_of_rotation_matrices() {
    let mut random = Random(1);
    let reference: Vec<_> = (0..500).map(|_| rotation(&mut random)).collect();
    let found: Vec<_> = (0..500).map(|_| rotation(&mut random)).collect();
    let scored: Vec<bool> = (0..500).map(|i| i % 3 == 1).collect();
    let trial = Trial {
        name: "a".into(),
        period: 0.01,
        samples: recording::still(500),
        // Some were not seen.
        reference: (0..500)
            .map(|i| (i % 7 != 0).then_some(reference[i]))
            .collect(),
        scored: scored.clone(),
    };
    let mut squares = [0.0; 3];
    let mut count = 0.0;
    for i in (0..500).filter(|i| scored[*i] && i % 7 != 0) {
        for (sum, part) in squares
            .iter_mut()
            .zip(by_matrices(&found[i], &reference[i]))
        {
            *sum += part * part;
        }
        count += 1.0;
    }
    let [inclination, heading, total] = squares.map(|sum: f64| (sum / count).sqrt());
    let score = Score::of(&trial, &found);
    for (a, b) in [
        (score.inclination, inclination),
        (score.heading, heading),
        (score.total, total),
    ] {
        assert!((a - b).abs() < 1e-6, "{a} and {b}");
    }
}

#[test]
fn a_constant_error_of_heading_is_aligned_away_and_a_tilt_is_not() {
    let mut random = Random(2);
    let reference: Vec<_> = (0..900).map(|_| rotation(&mut random)).collect();
    let turned = |axis: Vector3<f64>| {
        let turn = UnitQuaternion::from_scaled_axis(axis * 0.3);
        reference.iter().map(|q| turn * q).collect::<Vec<_>>()
    };
    let trial = Trial {
        name: "a".into(),
        period: 0.01,
        samples: recording::still(900),
        reference: reference.iter().copied().map(Some).collect(),
        scored: (0..900).map(|i| i > 800).collect(),
    };
    let degrees = 0.3_f64.to_degrees();
    let heading = Score::of(&trial, &turned(Vector3::y()));
    assert!((heading.heading - degrees).abs() < 1e-9 && (heading.total - degrees).abs() < 1e-9);
    assert!(
        heading.aligned < 1e-5 && heading.inclination < 1e-5,
        "{heading:?}"
    );
    let tilt = Score::of(&trial, &turned(Vector3::x()));
    assert!((tilt.inclination - degrees).abs() < 1e-9 && (tilt.aligned - degrees).abs() < 1e-5);
}

#[test]
fn what_is_no_rotation_counts_as_infinitely_wrong() {
    let trial = recording::trial(100);
    let mut found = vec![UnitQuaternion::identity(); 100];
    found[60] = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(f64::NAN, 0.0, 0.0, 0.0));
    assert_eq!(Score::of(&trial, &found).total, f64::INFINITY);
}

fn message(bytes: &[u8]) -> String {
    let folder = folder(&[("a.imub", bytes)]);
    let error = Trial::open_all(folder.path()).expect_err("it is refused");
    error.to_string()
}

#[test]
fn what_cannot_be_judged_is_refused_with_its_name_and_reason() {
    let good = Bytes::default();
    assert!(Trial::open_all(folder(&[("a.imub", &good.bytes())]).path()).is_ok());
    for (bytes, reason) in [
        (b"not a recording".to_vec(), "magic"),
        (good.bytes()[..200].to_vec(), "bytes"),
        (
            Bytes {
                rate: [0, 1],
                ..good.clone()
            }
            .bytes(),
            "sampling rate",
        ),
        (
            Bytes {
                scale: f32::NAN,
                ..good.clone()
            }
            .bytes(),
            "scale",
        ),
        (
            Bytes {
                scored: false,
                ..good.clone()
            }
            .bytes(),
            "nothing to score",
        ),
        (
            Bytes {
                seen: false,
                ..good.clone()
            }
            .bytes(),
            "nothing to score",
        ),
        (
            Bytes {
                reference: [0; 4],
                ..good.clone()
            }
            .bytes(),
            "not a rotation",
        ),
    ] {
        let said = message(&bytes);
        assert!(said.contains("a.imub") && said.contains(reason), "{said}");
    }
    let empty = Trial::open_all(folder(&[("notes.txt", b"")]).path()).unwrap_err();
    assert!(empty.to_string().contains("no .imub recording"), "{empty}");
    let missing = Trial::open_all(std::path::Path::new("no/such/folder")).unwrap_err();
    assert!(missing.to_string().contains("no/such/folder"), "{missing}");
}

#[test]
fn any_rate_is_judged_at_its_own() {
    for rate in [[100, 1], [2000, 7], [1000, 1]] {
        let bytes = Bytes {
            rate,
            ..Bytes::default()
        };
        let trials = Trial::open_all(folder(&[("a.imub", &bytes.bytes())]).path()).unwrap();
        let expected = f64::from(rate[1]) / f64::from(rate[0]);
        assert!((trials[0].period - expected).abs() < 1e-12);
        for estimator in estimators::ours() {
            for variant in Variant::ALL {
                let outcome = evaluation::run(std::slice::from_ref(&estimator), &trials, variant);
                let score = outcome[0][0].score;
                // A level board that lies still; only a bias may turn it.
                assert!(
                    score.inclination < 15.0,
                    "{} {variant:?}: {score:?}",
                    estimator.name
                );
            }
        }
    }
}
