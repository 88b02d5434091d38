//! Hard and soft iron are found to the accuracy stated, or refused with the right reason. The fields
//! are made of plain arrays in double precision; the library sees them through noise.

mod matrices;

mod random;

#[path = "ellipsoid/refused.rs"]
mod refused;

#[path = "ellipsoid/recordings.rs"]
mod recordings;

use matrices::{IDENTITY, Matrix, Vector, apply, largest_difference, length, product};
use nalgebra::{RealField, Vector3, convert};
use random::Random;
use vrduino::calibration::coverage::{DIRECTIONS, direction};
use vrduino::calibration::ellipsoid::{EllipsoidFit, Magnetometer, Refusal};
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
