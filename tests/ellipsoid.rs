//! Hard and soft iron are found to the accuracy stated, or refused with the right reason. The fields
//! are made of plain arrays in double precision; the library sees them through noise.

mod matrices;

mod random;

use matrices::{IDENTITY, Matrix, Vector, apply, largest_difference, length, product};
use nalgebra::{RealField, Vector3, convert};
use random::Random;
use vrduino::calibration::coverage::{DIRECTIONS, direction};
use vrduino::calibration::ellipsoid::{EllipsoidFit, Magnetometer, Refusal, Sighting};
use vrduino::sensor::magnetometer::FieldError;
use vrduino::units::MagneticField;

/// µT per axis, one standard deviation.
const NOISE: f64 = 0.6;

/// What a magnetometer amid iron reads: M · field + hard iron + noise.
#[derive(Clone, Copy)]
struct Amid {
    mixing: Matrix,
    hard_iron: Vector,
    strength: f64,
    noise: f64,
}

impl Amid {
    const TYPICAL: Self = Self {
        mixing: [[1.05, 0.02, -0.03], [0.02, 0.96, 0.01], [-0.03, 0.01, 1.0]],
        hard_iron: [31.0, -84.0, 12.5],
        strength: 48.0,
        noise: NOISE,
    };

    fn reads(&self, direction: Vector, random: &mut Random) -> Vector {
        let mixed = apply(&self.mixing, direction.map(|d| d * self.strength));
        [0, 1, 2].map(|i| mixed[i] + self.hard_iron[i] + self.noise * normal(random))
    }

    /// `count` samples from directions evenly at random of which `seen` approves.
    fn samples(&self, seed: u64, count: usize, seen: impl Fn(Vector) -> bool) -> Vec<Vector> {
        let mut random = Random(2 * seed + 1);
        let mut samples = Vec::with_capacity(count);
        while samples.len() < count {
            let direction = anywhere(&mut random);
            if seen(direction) {
                samples.push(self.reads(direction, &mut random));
            }
        }
        samples
    }

    /// `count` samples from one direction.
    fn still(&self, seed: u64, count: usize, direction: Vector) -> Vec<Vector> {
        let mut random = Random(2 * seed + 1);
        let samples = (0..count).map(|_| self.reads(direction, &mut random));
        samples.collect()
    }
}

/// Standard normal, to the accuracy of twelve uniform summands.
fn normal(random: &mut Random) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

/// A unit vector, evenly over the sphere.
fn anywhere(random: &mut Random) -> Vector {
    let v = [(); 3].map(|()| normal(random));
    v.map(|x| x / length(v))
}

/// Symmetric and near the identity, as soft iron is.
fn soft_iron(random: &mut Random) -> Matrix {
    let [a, b, c] = random.vector(0.12).map(|x| 1.0 + x);
    let [d, e, f] = random.vector(0.06);
    [[a, d, e], [d, b, f], [e, f, c]]
}

fn determinant([a, b, c]: &Matrix) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

fn field<T: RealField + Copy>(microtesla: Vector) -> MagneticField<T> {
    MagneticField::from_microtesla(Vector3::from(microtesla.map(convert::<f64, T>)))
}

fn fed<T: RealField + Copy>(samples: &[Vector]) -> EllipsoidFit {
    let mut fit = EllipsoidFit::new();
    for &sample in samples {
        fit.push(Ok(field::<T>(sample)));
    }
    fit
}

fn result(samples: &[Vector]) -> Result<Magnetometer<f32>, Refusal<f32>> {
    fed::<f32>(samples).result(25.0)
}

fn refused(samples: &[Vector]) -> Refusal<f32> {
    match result(samples) {
        Err(refusal) => refusal,
        Ok(result) => panic!("accepted: {result:?}"),
    }
}

fn array<T: RealField + Copy>(v: Vector3<T>) -> Vector {
    v.map(number).into()
}

fn number<T: RealField + Copy>(value: T) -> f64 {
    nalgebra::try_convert(value).expect("a number")
}

fn distance(a: Vector, b: Vector) -> f64 {
    length([0, 1, 2].map(|i| a[i] - b[i]))
}

/// How far hard iron (µT), soft iron (per element) and strength (µT) are off the truth.
fn errors<T: RealField + Copy>(found: &Magnetometer<T>, truth: &Amid) -> [f64; 3] {
    let soft = found.soft_iron;
    let soft = [0, 1, 2].map(|i| [0, 1, 2].map(|j| number(soft[(i, j)])));
    // A M is the identity but for the volume, which no sphere tells.
    let volume = determinant(&truth.mixing).cbrt();
    let undone = product(&soft, &truth.mixing).map(|row| row.map(|x| x / volume));
    [
        distance(array(found.hard_iron.microtesla()), truth.hard_iron),
        largest_difference(&undone, &IDENTITY),
        (number(found.strength_microtesla) - truth.strength * volume).abs(),
    ]
}

fn distortions_are_recovered<T: RealField + Copy>(noise: f64, largest: [f64; 3]) {
    for seed in 0..30 {
        let mut random = Random(1000 + seed);
        let truth = Amid {
            mixing: soft_iron(&mut random),
            hard_iron: random.vector(300.0),
            strength: random.between(26.0, 60.0),
            noise,
        };
        let fit = fed::<T>(&truth.samples(seed, 3000, |_| true));
        let found = fit
            .result::<T>(31.5)
            .unwrap_or_else(|refusal| panic!("{seed}: {refusal}"));
        let errors = errors(&found, &truth);
        assert!(
            (0..3).all(|i| errors[i] <= largest[i]),
            "{seed}: {errors:?}"
        );
        assert!(
            number(found.coverage) > 0.95,
            "{seed}: {:?}",
            found.coverage
        );
        assert_eq!(found.temperature_celsius, 31.5);
        // Noise along the radius, and nothing else but quarters of a microtesla.
        let expected = 100.0 * (noise * noise + 0.0052).sqrt() / truth.strength;
        let error = number(found.error_percent);
        assert!(
            (error / expected - 1.0).abs() < 0.25,
            "{seed}: {error} {expected}"
        );
    }
}

#[test]
fn any_distortion_is_recovered_from_clean_fields() {
    distortions_are_recovered::<f64>(0.0, [0.03, 0.001, 0.03]);
    distortions_are_recovered::<f32>(0.0, [0.03, 0.001, 0.03]);
}

#[test]
fn any_distortion_is_recovered_from_noisy_fields() {
    distortions_are_recovered::<f64>(NOISE, [0.15, 0.006, 0.1]);
    distortions_are_recovered::<f32>(NOISE, [0.15, 0.006, 0.1]);
}

#[test]
fn single_precision_finds_what_double_precision_finds() {
    for (seed, hole) in (0..20).zip([-1.0, -0.7].into_iter().cycle()) {
        let samples = Amid::TYPICAL.samples(seed, 2000, |d| d[1] > hole);
        let fit = fed::<f64>(&samples);
        let single = fit.result::<f32>(0.0).expect("good");
        let double = fit.result::<f64>(0.0).expect("good");
        let centre = |m: Vector3<f64>| array(m);
        let apart = distance(
            array(single.hard_iron.microtesla()),
            centre(double.hard_iron.microtesla()),
        );
        assert!(apart < 0.005, "{seed}: {apart}");
    }
}

#[test]
fn the_correction_makes_a_sphere_even_of_axes_that_are_turned() {
    // Misaligned axes: M is not symmetric, and its rotation stays unknown; the length is right.
    let truth = Amid {
        mixing: [[1.02, 0.08, -0.05], [-0.03, 0.97, 0.06], [0.07, -0.02, 1.0]],
        ..Amid::TYPICAL
    };
    let found = result(&truth.samples(5, 3000, |_| true)).expect("good");
    let calibration = found.calibration();
    let clean = Amid {
        noise: 0.0,
        ..truth
    };
    for sample in clean.samples(6, 500, |_| true) {
        let corrected = calibration
            .corrected(field::<f32>(sample))
            .microtesla()
            .norm();
        let off = (corrected / found.strength_microtesla - 1.0).abs();
        assert!(off < 0.005, "{off}");
    }
}

#[test]
fn a_hole_of_fifty_degrees_leaves_half_a_microtesla() {
    for seed in 0..20 {
        // Nothing within 48° of −y, and no direction of the map exactly there.
        let samples = Amid::TYPICAL.samples(seed, 2000, |d| d[1] > -48f64.to_radians().cos());
        let found = result(&samples).unwrap_or_else(|refusal| panic!("{seed}: {refusal}"));
        let [hard_iron, ..] = errors(&found, &Amid::TYPICAL);
        assert!(hard_iron < 0.5, "{seed}: {hard_iron}");
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
fn a_pause_of_ten_minutes_weighs_nothing() {
    let turning = Amid::TYPICAL.samples(8, 3000, |_| true);
    let (before, after) = turning.split_at(1500);
    // A cup of tea, with the board beside a radio that shifts the field by 1.5 µT.
    let mut moved = Amid::TYPICAL;
    moved.hard_iron[0] += 1.5;
    let pause = moved.still(9, 60_000, [0.0, -0.6, 0.8]);
    let found = result(&[before, &pause, after].concat()).expect("good");
    let [hard_iron, ..] = errors(&found, &Amid::TYPICAL);
    assert!(hard_iron < 0.25, "{hard_iron}");
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

#[test]
fn the_procedure_stays_small() {
    assert!(
        size_of::<EllipsoidFit>() <= 2700,
        "{}",
        size_of::<EllipsoidFit>()
    );
}

#[test]
fn the_directions_of_the_map_are_spread_evenly() {
    for i in 0..DIRECTIONS {
        let own = direction::<f64>(i);
        assert!((own.norm() - 1.0).abs() < 1e-12);
        let others = (0..DIRECTIONS).filter(|&j| j != i);
        let nearest = others.map(|j| own.angle(&direction(j))).reduce(f64::min);
        let degrees = nearest.expect("there are others").to_degrees();
        assert!((15.0..23.0).contains(&degrees), "{i}: {degrees}");
    }
}
