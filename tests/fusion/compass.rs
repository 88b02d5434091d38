//! The heading by compass: north is north, tilt is left alone, magnets are noticed.

use vrduino::fusion::{FieldVerdict, Fusion, Parameters};

use crate::matrices::{Vector, degrees_between, product, rotation, transpose};
use crate::world::{Body, DT, EARTH, dps, field, fusion, matrix, sample};

fn feed(fusion: &mut Fusion<f64>, body: &mut Body, rate: Vector) {
    let (rate, force, m) = body.read(rate, [0.0; 3]);
    fusion.update(&sample(rate, force), Some(field(m)));
}

fn off(fusion: &Fusion<f64>, body: &Body) -> f64 {
    degrees_between(&matrix(&fusion.orientation()), &body.attitude)
}

/// To and fro about the vertical, 40 °/s.
fn look_around(t: f64) -> Vector {
    dps([0.0, 40.0 * t.sin(), 0.0])
}

#[test]
fn north_is_found_from_any_heading_within_seconds() {
    for degrees in [-170.0_f64, -100.0, -30.0, 0.0, 45.0, 90.0, 135.0, 179.0] {
        let mut fusion = fusion::<f64>(&Parameters::default());
        let mut body = Body::level();
        body.attitude = rotation([0.0, 1.0, 0.0], degrees.to_radians());
        for _ in 0..3000 {
            feed(&mut fusion, &mut body, [0.0; 3]);
        }
        assert!(
            off(&fusion, &body) < 0.5,
            "{degrees}: {}°",
            off(&fusion, &body)
        );
        assert_eq!(fusion.field_verdict(), FieldVerdict::Undisturbed);
    }
}

#[test]
fn the_field_never_touches_the_tilt() {
    let (mut with, mut without) = (
        fusion::<f64>(&Parameters::default()),
        fusion::<f64>(&Parameters::default()),
    );
    let mut body = Body::level();
    for i in 0..20_000 {
        let t = f64::from(i) * DT;
        // A field of any direction and size.
        body.field = [
            60.0 * (3.0 * t).sin(),
            50.0 * (5.0 * t).cos(),
            40.0 * t.sin(),
        ];
        let (rate, force, m) = body.read([t.sin(), (2.0 * t).cos(), (3.0 * t).sin()], [0.0; 3]);
        let sample = sample(rate, force);
        // The bias of the two must not part either, or the tilt would follow: no heading integral.
        with.update(&sample, Some(field(m)));
        without.update(&sample, None);
        let up = |fusion: &Fusion<f64>| matrix(&fusion.orientation())[1];
        let (a, b) = (up(&with), up(&without));
        let apart = (0..3).map(|k| (a[k] - b[k]).abs()).sum::<f64>();
        assert!(apart < 0.02, "{apart} after {i}");
    }
}

#[test]
fn without_a_field_the_heading_is_the_gyros() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = Body::level();
    for i in 0..10_000 {
        let (rate, force, _) = body.read(look_around(f64::from(i) * DT), [0.0; 3]);
        fusion.update(&sample(rate, force), None);
    }
    assert_eq!(fusion.field_verdict(), FieldVerdict::Absent);
    assert!(off(&fusion, &body) < 0.01, "{}", off(&fusion, &body));
}

#[test]
fn a_magnet_that_comes_and_goes_does_not_turn_the_picture() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = Body::level();
    let mut worst = 0.0_f64;
    for i in 0..60_000 {
        let t = f64::from(i) * DT;
        body.field = if (20.0..25.0).contains(&t) {
            [30.0, -20.0, 10.0]
        } else {
            EARTH
        };
        feed(&mut fusion, &mut body, look_around(t));
        if (21.0..25.0).contains(&t) {
            assert_eq!(fusion.field_verdict(), FieldVerdict::Disturbed);
        }
        if t > 5.0 {
            worst = crate::matrices::larger(worst, off(&fusion, &body));
        }
    }
    assert!(worst < 0.5, "{worst}°");
    assert_eq!(fusion.field_verdict(), FieldVerdict::Undisturbed);
}

#[test]
fn started_beside_a_magnet_it_finds_north_after_it_has_left() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = Body::level();
    body.field = [25.0, -60.0, 0.0];
    for _ in 0..3000 {
        feed(&mut fusion, &mut body, [0.0; 3]);
    }
    assert!(off(&fusion, &body) > 80.0, "it points to the magnet");
    body.field = EARTH;
    for i in 0..60_000 {
        feed(&mut fusion, &mut body, look_around(f64::from(i) * DT));
    }
    assert!(off(&fusion, &body) < 3.0, "{}°", off(&fusion, &body));
}

#[test]
fn a_magnet_fixed_to_the_world_beside_a_resting_board_is_not_taken_for_the_earth() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = Body::level();
    for i in 0..20_000 {
        feed(&mut fusion, &mut body, look_around(f64::from(i) * DT));
    }
    let before = off(&fusion, &body);
    // Something of iron is put down beside it for two minutes; the board lies still.
    body.field = [30.0, -10.0, 5.0];
    for _ in 0..120_000 {
        feed(&mut fusion, &mut body, [0.0; 3]);
    }
    assert_eq!(fusion.field_verdict(), FieldVerdict::Disturbed);
    assert!(
        off(&fusion, &body) < before + 0.5,
        "{}°",
        off(&fusion, &body)
    );
}

#[test]
fn a_vertical_field_has_no_north() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = Body::level();
    body.field = [0.0, -50.0, 0.0];
    for _ in 0..3000 {
        feed(&mut fusion, &mut body, [0.0; 3]);
    }
    assert_eq!(fusion.field_verdict(), FieldVerdict::Absent);
    assert!(off(&fusion, &body) < 1e-6);
}

#[test]
fn a_reset_faces_ahead_for_good_and_the_compass_holds_it() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = Body {
        bias: dps([0.0, 0.5, 0.0]),
        ..Body::level()
    };
    let start = rotation([0.0, 1.0, 0.0], 1.0);
    body.attitude = start;
    for _ in 0..3000 {
        feed(&mut fusion, &mut body, [0.0; 3]);
    }
    let (_, force, _) = body.read([0.0; 3], [0.0; 3]);
    fusion.reset(vrduino::units::SpecificForce::from_m_per_s2(force.into()));
    for i in 0..60_000 {
        feed(&mut fusion, &mut body, look_around(f64::from(i) * DT));
        // North is 57° away; ahead is where it looked when it was reset.
        let ahead = product(&transpose(&start), &body.attitude);
        let off = degrees_between(&matrix(&fusion.orientation()), &ahead);
        assert!(off < 1.5, "{off}° after {i}");
    }
}
