//! Each bad set of fields is refused, and the reason is the right one.

use crate::matrices::Vector;
use crate::random::Random;
use crate::{Amid, anywhere, errors, fed, field, result};
use vrduino::calibration::ellipsoid::{EllipsoidFit, Refusal, Sighting};
use vrduino::sensor::magnetometer::FieldError;
use vrduino::units::MagneticField;

fn refused(samples: &[Vector]) -> Refusal<f32> {
    match result(samples) {
        Err(refusal) => refusal,
        Ok(result) => panic!("accepted: {result:?}"),
    }
}

#[test]
fn half_a_sphere_is_refused_and_the_hole_named() {
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let samples = Amid::TYPICAL.samples(3, 3000, |d| sign * d[axis] > 0.0);
            let refusal = refused(&samples);
            let Refusal::Coverage(coverage) = refusal else {
                panic!("{refusal}");
            };
            assert!((0.4..0.75).contains(&coverage.share), "{coverage:?}");
            let hole = coverage.largest_hole.degrees();
            assert!((55.0..95.0).contains(&hole), "{coverage:?}");
            assert!(f64::from(coverage.hole[axis]) * sign < -0.8, "{coverage:?}");
            let sign = if sign > 0.0 { '-' } else { '+' };
            let end = format!("comes from {sign}{}", ['x', 'y', 'z'][axis]);
            assert!(refusal.to_string().ends_with(&end), "{refusal}");
        }
    }
}

#[test]
fn a_turn_about_one_axis_is_flat() {
    for seed in 0..20 {
        let normal = anywhere(&mut Random(77 + seed));
        let across = |d: Vector| d.iter().zip(normal).map(|(a, b)| a * b).sum::<f64>();
        // A level turn about the vertical, the hand a few degrees off.
        for height in [0.0, 0.5] {
            let near = |d: Vector| (across(d) - height).abs() < 0.05;
            let refusal = refused(&Amid::TYPICAL.samples(seed, 1000, near));
            assert!(matches!(refusal, Refusal::Flat), "{seed}: {refusal}");
        }
    }
}

#[test]
fn a_board_that_lies_still_is_refused() {
    let refusal = refused(&Amid::TYPICAL.still(1, 60_000, [0.6, 0.0, 0.8]));
    let reason = matches!(refusal, Refusal::TooFew { .. } | Refusal::DeadAxis { .. });
    assert!(reason, "{refusal}");
    assert!(matches!(refused(&[]), Refusal::TooFew { samples: 0, .. }));
}

#[test]
fn a_field_that_changes_from_place_to_place_is_disturbed() {
    // Walking past a radiator while turning: up to 15 µT along the world's x, in the board's axes.
    let mut random = Random(21);
    let samples: Vec<_> = (0..3000)
        .map(|_| {
            let direction = anywhere(&mut random);
            let mut read = Amid::TYPICAL.reads(direction, &mut random);
            let extra = random.between(0.0, 15.0);
            read.iter_mut()
                .zip(direction)
                .for_each(|(r, d)| *r += extra * d);
            read
        })
        .collect();
    let refusal = refused(&samples);
    assert!(matches!(refusal, Refusal::Disturbed(_)), "{refusal}");
}

#[test]
fn a_magnet_on_the_board_is_hard_iron_and_one_that_passes_is_not() {
    let magnet = Amid {
        hard_iron: [900.0, -1300.0, 400.0],
        ..Amid::TYPICAL
    };
    let samples = magnet.samples(4, 3000, |_| true);
    let [hard_iron, ..] = errors(&result(&samples).expect("it turns with the board"), &magnet);
    assert!(hard_iron < 0.15, "{hard_iron}");
    // It falls off half way.
    let samples = [&samples[..1500], &Amid::TYPICAL.samples(4, 1500, |_| true)].concat();
    assert!(matches!(
        refused(&samples),
        Refusal::Magnet { samples: 1500 }
    ));
    // One of 60 µT that comes and goes leaves no sphere.
    let mut passing = Amid::TYPICAL;
    passing.hard_iron[1] += 60.0;
    let samples = [
        Amid::TYPICAL.samples(4, 1500, |_| true),
        passing.samples(5, 1500, |_| true),
    ]
    .concat();
    let refusal = refused(&samples);
    let reason = matches!(refusal, Refusal::Disturbed(_) | Refusal::Lopsided(_));
    assert!(reason, "{refusal}");
}

#[test]
fn overflow_and_what_is_no_number_are_refused_however_good_the_rest() {
    let good = Amid::TYPICAL.samples(2, 3000, |_| true);
    let with = |bad: Result<MagneticField<f32>, FieldError>| {
        let mut fit = fed::<f32>(&good);
        assert!(fit.result::<f32>(20.0).is_ok());
        assert_eq!(fit.push(bad), Sighting::Unusable);
        fit.result::<f32>(20.0).expect_err("one is enough")
    };
    assert!(matches!(
        with(Err(FieldError::Overflow)),
        Refusal::Magnet { samples: 1 }
    ));
    let unreadable = |refusal| matches!(refusal, Refusal::Unreadable { samples: 1 });
    assert!(unreadable(with(Err(FieldError::OutOfRange))));
    for bad in [f64::NAN, f64::INFINITY, -1e300] {
        assert!(unreadable(with(Ok(field([40.0, bad, 0.0])))), "{bad}");
    }
    assert!(matches!(
        with(Ok(field([1e30, 0.0, 0.0]))),
        Refusal::Magnet { samples: 1 }
    ));
}

#[test]
fn dead_and_weak_axes_are_told_from_iron() {
    for axis in 0..3 {
        let mut dead = Amid::TYPICAL;
        dead.mixing[axis] = [0.0; 3];
        let refusal = refused(&dead.samples(6, 3000, |_| true));
        assert!(
            matches!(refusal, Refusal::DeadAxis { axis: a } if a == axis),
            "{refusal}"
        );
        let mut weak = Amid::TYPICAL;
        weak.mixing[axis] = weak.mixing[axis].map(|x| 0.5 * x);
        let refusal = refused(&weak.samples(6, 3000, |_| true));
        assert!(
            matches!(refusal, Refusal::Lopsided(ratio) if ratio > 1.7),
            "{refusal}"
        );
    }
}

#[test]
fn a_field_that_is_not_the_earths_is_refused() {
    for strength in [14.0, 85.0] {
        let other = Amid {
            strength,
            noise: 0.1,
            ..Amid::TYPICAL
        };
        let refusal = refused(&other.samples(6, 3000, |_| true));
        let near = |found: f32| (f64::from(found) / strength - 1.0).abs() < 0.02;
        assert!(
            matches!(refusal, Refusal::Strength(found) if near(found)),
            "{refusal}"
        );
    }
}

#[test]
fn points_in_a_ball_are_no_sphere() {
    let mut random = Random(5);
    let samples: Vec<_> = (0..5000)
        .map(|_| {
            let size = 60.0 * random.unit().cbrt();
            anywhere(&mut random).map(|d| d * size)
        })
        .collect();
    let refusal = refused(&samples);
    assert!(matches!(refusal, Refusal::Disturbed(_)), "{refusal}");
}

#[test]
fn whatever_comes_there_is_no_panic_and_only_finite_results() {
    for seed in 0..100 {
        let mut random = Random(9000 + seed);
        let mut fit = EllipsoidFit::new();
        let size = 10f64.powf(random.between(-2.0, 5.0));
        let flat = random.unit();
        for _ in 0..1500 {
            let [x, y, z] = random.vector(size);
            fit.push(Ok(field::<f32>([x, y * flat, z * (random.unit() - flat)])));
        }
        if let Ok(found) = fit.result::<f32>(20.0) {
            assert!(found.soft_iron.iter().all(|x| x.is_finite()));
        }
        let _ = fit
            .result::<f64>(f32::NAN)
            .map_err(|refusal| refusal.to_string());
    }
}
