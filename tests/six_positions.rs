//! The accelerometer's faults are found from a board laid on its six faces, to the accuracy stated,
//! or refused with the right reason. The forces are made of plain arrays in double precision.

mod matrices;

mod random;

use matrices::{IDENTITY, Matrix, Vector, apply, largest_difference, length, product, rotation};
use nalgebra::{RealField, Vector3, convert};
use random::Random;
use vrduino::calibration::WINDOW;
use vrduino::calibration::six_positions::{
    Accelerometer, CrossAxis, Position, Refusal, SixPositions, Step, WINDOWS_PER_FACE,
};
use vrduino::sensor::{AccelRange, GyroRange, Ranges, RawSample};
use vrduino::units::SpecificForce;

const RANGES: Ranges = Ranges {
    gyro: GyroRange::Dps2000,
    accel: AccelRange::G16,
};
const G: f64 = 9.81;

/// Up, in the body, with the board exactly on each face; in the order of `Position::ALL`.
const UP: [Vector; 6] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
];

/// A sensor that reads M · force + bias, m/s².
#[derive(Clone, Copy)]
struct Faulty {
    mixing: Matrix,
    bias: Vector,
}

const GOOD: Faulty = Faulty {
    mixing: IDENTITY,
    bias: [0.0; 3],
};

impl Faulty {
    /// As the data sheet allows: 3 % of scale, 2 % across, 60 mg.
    fn random(random: &mut Random) -> Self {
        let mut mixing = [(); 3].map(|()| random.vector(0.02));
        for (axis, row) in mixing.iter_mut().enumerate() {
            row[axis] = 1.0 + random.between(-0.03, 0.03);
        }
        let bias = random.vector(0.06 * G);
        Self { mixing, bias }
    }

    fn without_cross_axis(self) -> Self {
        let mut mixing = IDENTITY;
        (0..3).for_each(|axis| mixing[axis][axis] = self.mixing[axis][axis]);
        Self { mixing, ..self }
    }

    /// The mean of a still second with the board this much off its face (°, any direction).
    fn on(&self, face: usize, tilt: f64, random: &mut Random) -> Vector {
        let axis = random.vector(1.0);
        let axis = axis.map(|a| a / length(axis));
        let up = apply(&rotation(axis, tilt.to_radians()), UP[face]);
        let read = apply(&self.mixing, up.map(|u| u * G));
        [0, 1, 2].map(|i| read[i] + self.bias[i] + random.between(-0.002, 0.002))
    }
}

fn force<T: RealField + Copy>(m_per_s2: Vector) -> SpecificForce<T> {
    SpecificForce::from_m_per_s2(Vector3::from(m_per_s2.map(convert::<f64, T>)))
}

/// Each face in `windows` placings of up to `tilt` degrees.
fn placed<T: RealField + Copy>(
    sensor: &Faulty,
    tilt: f64,
    windows: u32,
    seed: u64,
) -> SixPositions<T> {
    let mut random = Random(2 * seed + 1);
    let mut procedure = SixPositions::new(RANGES);
    for window in 1..=windows {
        for (face, expected) in Position::ALL.into_iter().enumerate() {
            let tilt = random.between(0.0, tilt);
            let step = procedure.place(force(sensor.on(face, tilt, &mut random)), 25.0);
            let Step::Taken { face, windows } = step else {
                panic!("{step:?}");
            };
            assert_eq!((face, windows), (expected, window));
        }
    }
    procedure
}

fn number<T: RealField + Copy>(value: T) -> f64 {
    nalgebra::try_convert(value).expect("a number")
}

fn matrix<T: RealField + Copy>(result: &Accelerometer<T>) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| number(result.matrix[(i, j)])))
}

fn bias_error<T: RealField + Copy>(result: &Accelerometer<T>, truth: &Faulty) -> f64 {
    let bias: Vector = result.bias.m_per_s2().map(number).into();
    (0..3)
        .map(|i| (bias[i] - truth.bias[i]).abs())
        .fold(0.0, f64::max)
}

fn scale_and_bias_are_recovered<T: RealField + Copy>() {
    for seed in 0..200 {
        let truth = Faulty::random(&mut Random(seed + 500)).without_cross_axis();
        // A hand that places to 5°.
        let result = placed::<T>(&truth, 5.0, 2, seed).result(CrossAxis::Ignore);
        let result = result.unwrap_or_else(|refusal| panic!("{seed}: {refusal}"));
        let undone = largest_difference(&product(&matrix(&result), &truth.mixing), &IDENTITY);
        assert!(undone < 0.0006, "{seed}: {undone}");
        let bias = bias_error(&result, &truth);
        assert!(bias < 0.006, "{seed}: {bias}");
        assert!(number(result.residual) < 0.003, "{seed}");
        assert_eq!(result.temperature_celsius, 25.0);
    }
}

#[test]
fn scale_and_bias_do_not_suffer_from_bad_placing() {
    scale_and_bias_are_recovered::<f64>();
    scale_and_bias_are_recovered::<f32>();
}

#[test]
fn cross_axis_terms_disturb_scale_and_bias_little() {
    for seed in 0..200 {
        let truth = Faulty::random(&mut Random(seed + 900));
        let result = placed::<f32>(&truth, 5.0, 2, seed).result(CrossAxis::Ignore);
        let result = result.unwrap_or_else(|refusal| panic!("{seed}: {refusal}"));
        for axis in 0..3 {
            let scale = matrix(&result)[axis][axis] * truth.mixing[axis][axis];
            assert!((scale - 1.0).abs() < 0.004, "{seed}: {scale}");
        }
        let bias = bias_error(&result, &truth);
        assert!(bias < 0.05, "{seed}: {bias}");
    }
}

#[test]
fn a_true_block_tells_the_cross_axis_terms_too() {
    for seed in 0..100 {
        let truth = Faulty::random(&mut Random(seed + 700));
        let procedure = placed::<f32>(&truth, 0.1, 3, seed);
        let result = procedure.result(CrossAxis::FromFaces);
        let result = result.unwrap_or_else(|refusal| panic!("{seed}: {refusal}"));
        let undone = largest_difference(&product(&matrix(&result), &truth.mixing), &IDENTITY);
        assert!(undone < 0.003, "{seed}: {undone}");
        let placing = result.placing.degrees();
        assert!(placing < 0.15, "{seed}: {placing}");
    }
}

#[test]
fn the_placing_error_is_measured_and_cross_axis_terms_refused() {
    // One standard deviation per axis: 4° at most, at random in size and direction.
    let mut squares = 0.0;
    for seed in 0..200 {
        let procedure = placed::<f64>(&GOOD, 4.0, 2, seed);
        let result = procedure.result(CrossAxis::Ignore).expect("good");
        // Two placings in each face's mean.
        squares += 2.0 * result.placing.degrees().powi(2);
        if result.placing.degrees() > 0.4 {
            let refusal = procedure.result(CrossAxis::FromFaces).expect_err("bad");
            assert!(matches!(refusal, Refusal::Placing(_)), "{refusal}");
        }
    }
    let rms = (squares / 200.0).sqrt();
    // Mean square 4²/3; the axis of the tilt is anywhere in a cube's directions, a third of it along
    // the face's own axis, where it turns nothing: 4²/3 · 1/3 remains for each of two.
    let expected = (16.0f64 / 9.0).sqrt();
    assert!((rms / expected - 1.0).abs() < 0.15, "{rms} {expected}");
}

#[test]
fn faces_are_known_in_any_order_and_tilted_ones_named() {
    let mut procedure = SixPositions::<f32>::new(RANGES);
    let mut random = Random(3);
    for face in [4, 0, 3, 3, 5, 2, 1] {
        let step = procedure.place(force(GOOD.on(face, 10.0, &mut random)), 20.0);
        assert!(matches!(step, Step::Taken { face: f, .. } if f == Position::ALL[face]));
    }
    for degrees in [16.0f64, 30.0, 44.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let step = procedure.place(force([-G * cos, 0.0, G * sin]), 20.0);
        let Step::Tilted { nearest, tilt } = step else {
            panic!("{step:?}");
        };
        assert_eq!(nearest, Position::XDown);
        assert!((f64::from(tilt.degrees()) - degrees).abs() < 0.01);
    }
    for bad in [0.0, 0.7 * G, 1.3 * G, f64::NAN, f64::INFINITY, -1e300] {
        let step = procedure.place(force([0.0, bad, 0.0]), 20.0);
        assert_eq!(step, Step::NotGravity, "{bad}");
    }
    assert_eq!(
        procedure.place(force([0.0, G, 0.0]), f32::NAN),
        Step::NotGravity
    );
    // One window too few of all but y down.
    let missing = procedure.missing();
    assert_eq!(missing.to_string(), "x up, x down, y up, z up, z down");
    let refusal = procedure.result(CrossAxis::Ignore).expect_err("missing");
    assert_eq!(refusal, Refusal::Missing(missing));
}

/// A second of samples at ±16 g, with the data sheet's noise and a shake (m/s²).
fn second(
    procedure: &mut SixPositions<f32>,
    mean: Vector,
    shake: f64,
    temperature: i16,
) -> Step<f32> {
    let mut random = Random(71);
    let mut last = None;
    for i in 0..WINDOW {
        let sway = shake * (f64::from(i) * 0.05).sin();
        let accel = mean.map(|a| {
            let noise = random.between(-0.075, 0.075);
            ((a + noise + sway) * 2048.0 / G)
                .round()
                .clamp(-32768.0, 32767.0) as i16
        });
        assert_eq!(last, None, "a window ended early");
        last = procedure.push(&RawSample {
            gyro: [3, -5, 8],
            accel,
            temperature,
            fresh: true,
        });
    }
    last.expect("a window is full")
}

#[test]
fn from_raw_samples_only_what_lies_still_counts() {
    let truth = Faulty::random(&mut Random(42)).without_cross_axis();
    let mut procedure = SixPositions::<f32>::new(RANGES);
    let mut random = Random(5);
    for _ in 0..3 {
        let step = second(&mut procedure, truth.on(2, 1.0, &mut random), 2.0, 0);
        assert_eq!(step, Step::Moved);
    }
    let refusal = procedure.result(CrossAxis::Ignore).expect_err("moved");
    assert_eq!(refusal, Refusal::NeverStill { windows: 3 });
    for face in 0..6 {
        let mean = truth.on(face, 3.0, &mut random);
        assert_eq!(second(&mut procedure, mean, 2.0, 1336), Step::Moved);
        for windows in 1..=WINDOWS_PER_FACE {
            let taken = Step::Taken {
                face: Position::ALL[face],
                windows,
            };
            assert_eq!(second(&mut procedure, mean, 0.0, 1336), taken);
        }
    }
    let result = procedure.result(CrossAxis::Ignore).expect("good");
    assert!(bias_error(&result, &truth) < 0.01);
    // 1336 / 333.87 + 21.
    assert!((result.temperature_celsius - 25.0).abs() < 0.01);
}

fn refused(sensor: &Faulty) -> Refusal<f32> {
    let result = placed::<f32>(sensor, 3.0, 2, 11).result(CrossAxis::Ignore);
    result.expect_err("bad")
}

#[test]
fn faults_far_beyond_the_data_sheet_are_refused() {
    for axis in 0..3 {
        for factor in [0.92, 1.08] {
            let mut sensor = GOOD;
            sensor.mixing[axis][axis] = factor;
            let refusal = refused(&sensor);
            let Refusal::Scale { axis: a, percent } = refusal else {
                panic!("{refusal}");
            };
            assert_eq!(a, axis);
            assert!(
                (f64::from(percent) - 100.0 * (factor - 1.0)).abs() < 0.5,
                "{percent}"
            );
        }
        let mut sensor = GOOD;
        sensor.bias[axis] = -0.22 * G;
        let refusal = refused(&sensor);
        assert!(
            matches!(refusal, Refusal::Bias { axis: a, .. } if a == axis),
            "{refusal}"
        );
    }
}

#[test]
fn positions_that_do_not_agree_are_refused() {
    // A table in a lift: the second round is 2 % heavier.
    let mut procedure = SixPositions::<f32>::new(RANGES);
    let mut random = Random(9);
    for heavier in [1.0, 1.02] {
        for face in 0..6 {
            let read = GOOD.on(face, 2.0, &mut random).map(|a| a * heavier);
            procedure.place(force(read), 25.0);
        }
    }
    let refusal = procedure.result(CrossAxis::Ignore).expect_err("lift");
    assert!(
        matches!(refusal, Refusal::Residual(rms) if rms > 0.08),
        "{refusal}"
    );
}

#[test]
fn a_sensor_that_warms_up_is_refused() {
    let mut procedure = placed::<f32>(&GOOD, 3.0, 2, 1);
    assert!(procedure.result(CrossAxis::Ignore).is_ok());
    procedure.place(force([0.0, G, 0.0]), 36.0);
    let refusal = procedure.result(CrossAxis::Ignore).expect_err("warm");
    assert_eq!(refusal, Refusal::Warming(11.0));
    assert!(
        refusal
            .to_string()
            .ends_with("let it run ten minutes first")
    );
}

#[test]
fn whatever_is_placed_there_is_no_panic_and_only_finite_results() {
    for seed in 0..300 {
        let mut random = Random(8000 + seed);
        let mut procedure = SixPositions::<f32>::new(RANGES);
        let noise = 10f64.powf(random.between(-4.0, 0.5));
        for _ in 0..60 {
            let face = UP[(random.unit() * 6.0) as usize % 6];
            let off = random.vector(noise);
            let read = [0, 1, 2].map(|i| face[i] * G + off[i]);
            procedure.place(force(read), random.between(20.0, 29.0) as f32);
        }
        for cross_axis in [CrossAxis::Ignore, CrossAxis::FromFaces] {
            match procedure.result(cross_axis) {
                Ok(result) => assert!(result.matrix.iter().all(|x| x.is_finite())),
                Err(refusal) => assert!(!refusal.to_string().is_empty()),
            }
        }
    }
}

#[test]
fn the_procedure_stays_small() {
    let size = size_of::<SixPositions<f32>>();
    assert!(size <= 1024, "{size}");
}
