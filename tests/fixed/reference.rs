//! Beside the readable filter in double precision, on the same counts.

use crate::motion::{Motion, PERIOD};
use crate::random::Random;
use vrduino::calibration::GyroBias;
use vrduino::fixed::complementary::{Bias, Complementary, Force, Nanoseconds, Parameters};
use vrduino::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use vrduino::orientation::{TimeConstant, complementary};
use vrduino::sensor::{AccelRange, GyroRange, Ranges, RawSample, Sample};
use vrduino::units::{AngularRate, Seconds, SpecificForce};

const SAMPLES: usize = 20_000;
const SEEDS: u64 = 24;
/// What the integers may be off by, in degrees.
const ALLOWED: f64 = 1e-4;

pub fn orientation(filter: &Complementary) -> UnitQuaternion<f64> {
    let [w, x, y, z] = filter
        .bits()
        .map(|bits| f64::from(bits) / f64::from(1 << 30));
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

/// The angle between two, in degrees; by the sine of its half, which keeps its digits near zero.
pub fn degrees_apart(a: UnitQuaternion<f64>, b: UnitQuaternion<f64>) -> f64 {
    2.0 * (a.inverse() * b).imag().norm().min(1.0).asin().to_degrees()
}

/// Both filters.
pub struct Pair {
    ranges: Ranges,
    bias: GyroBias<f64>,
    fixed: Complementary,
    reference: complementary::Complementary<f64>,
}

impl Pair {
    pub fn new(ranges: Ranges, time: f32, bias_parts: [i32; 3]) -> Self {
        let mut fixed = Complementary::new(&Parameters {
            gyro: ranges.gyro,
            sample_period: Nanoseconds(1_000_000),
            time_constant: TimeConstant::new(Seconds(time)),
        });
        fixed.set_bias(Bias::from_parts_of_counts(bias_parts));
        let dps_per_part = ranges.gyro.max_dps() / f64::from(1 << 30);
        let dps = Vector3::from(bias_parts.map(|part| f64::from(part) * dps_per_part));
        Self {
            ranges,
            bias: GyroBias::new(AngularRate::from_dps(dps)),
            fixed,
            reference: complementary::Complementary::new(
                TimeConstant::new(Seconds(f64::from(time))),
                Seconds(PERIOD),
            ),
        }
    }

    pub fn reset(&mut self, raw: &RawSample) {
        self.fixed.reset(Force::from_counts(raw.accel));
        self.reference.reset(self.ranges.sample(raw).force);
    }

    /// Both take the sample; how far apart they are then, in degrees.
    pub fn update(&mut self, raw: &RawSample) -> f64 {
        self.fixed.update(raw);
        let reading = self.bias.correct(self.ranges.sample(raw));
        let reference = self.reference.update(&reading);
        degrees_apart(reference, orientation(&self.fixed))
    }
}

pub const FAST: Ranges = Ranges {
    gyro: GyroRange::Dps2000,
    accel: AccelRange::G2,
};

pub fn about(seed: u64) -> UnitQuaternion<f64> {
    let mut random = Random(seed * 77 + 5);
    UnitQuaternion::from_scaled_axis(Vector3::from(random.vector(1.5)))
}

/// The largest difference of 20 s.
fn worst(mut motion: Motion, time: f32, levelled: bool) -> f64 {
    let mut pair = Pair::new(motion.ranges, time, motion.bias_parts());
    let first = motion.next();
    if levelled {
        pair.reset(&first);
    }
    let mut worst = pair.update(&first);
    for _ in 1..SAMPLES {
        worst = worst.max(pair.update(&motion.next()));
    }
    worst
}

fn check(name: &str, worst: impl Fn(u64) -> f64) {
    let worst = (1..=SEEDS).map(worst).fold(0.0, f64::max);
    println!("{name}: {worst:.2e} degrees at most");
    assert!(worst <= ALLOWED, "{name}: {worst:e} degrees");
}

#[test]
fn it_follows_the_reference_at_rest() {
    check("at rest", |seed| {
        worst(Motion::new(seed, FAST, about(seed), 0.0, 1.0), 7.6, true)
    });
}

#[test]
fn it_follows_the_reference_on_a_head() {
    check("head", |seed| {
        worst(Motion::new(seed, FAST, about(seed), 300.0, 2.0), 7.6, true)
    });
}

#[test]
fn it_follows_the_reference_at_the_ends_of_the_range() {
    check("fast", |seed| {
        worst(Motion::new(seed, FAST, about(seed), 1990.0, 3.0), 7.6, true)
    });
}

/// From the identity, though the body hangs upside down: nearly all the way on the path for large tilts.
#[test]
fn it_follows_the_reference_from_a_flipped_start() {
    check("flipped", |seed| {
        let mut random = Random(seed * 31 + 1);
        let axis = Vector3::new(random.between(-1.0, 1.0), 0.0, random.between(-1.0, 1.0));
        let angle = random.between(2.6, 3.1);
        let start = UnitQuaternion::from_scaled_axis(axis.normalize() * angle);
        let time = random.between(0.3, 7.6) as f32;
        worst(Motion::new(seed, FAST, start, 20.0, 0.5), time, false)
    });
}

/// α of 0.9 and below: 10 ms is one of 0.909, 1 ms of 0.5, and 0 of 0, the accelerometer's tilt alone.
#[test]
fn it_follows_the_reference_with_short_time_constants() {
    for time in [0.1, 0.01, 0.005, 0.001, 0.0] {
        check(&format!("{time} s"), |seed| {
            worst(Motion::new(seed, FAST, about(seed), 200.0, 2.0), time, true)
        });
    }
}

#[test]
fn it_follows_the_reference_in_every_range() {
    for gyro in GyroRange::ALL {
        for accel in AccelRange::ALL {
            let ranges = Ranges { gyro, accel };
            check(&format!("{ranges:?}"), |seed| {
                let dps = gyro.max_dps() / 3.0;
                worst(Motion::new(seed, ranges, about(seed), dps, 2.0), 7.6, true)
            });
        }
    }
}

/// Beyond the range for nearly half of the time: both see what the registers hold.
#[test]
fn it_follows_the_reference_on_a_gyro_that_clips() {
    check("clipped", |seed| {
        worst(Motion::new(seed, FAST, about(seed), 8000.0, 3.0), 7.6, true)
    });
}

/// A body that turns evenly about one of its axes for 20 s, and a sensor without noise: whatever is rounded off is
/// rounded off the same way again and again. A rate below that of a count is what the bias leaves of none.
fn evenly(dps: f64, axis: usize, start: UnitQuaternion<f64>) -> f64 {
    let range = FAST.gyro.max_dps();
    let measured = (dps / range * 32768.0).round().clamp(-32768.0, 32767.0);
    let mut gyro = [0; 3];
    gyro[axis] = measured as i16;
    let mut bias_parts = [0; 3];
    if dps.abs() < range {
        bias_parts[axis] = ((measured - dps / range * 32768.0) * 32768.0).round() as i32;
    }
    let mut rate_dps = Vector3::zeros();
    rate_dps[axis] = dps;
    let step = UnitQuaternion::from_scaled_axis(rate_dps * PERIOD.to_radians());
    let mut pair = Pair::new(FAST, 7.6, bias_parts);
    let mut truth = start;
    let mut worst = 0.0;
    for number in 0..SAMPLES {
        truth *= step;
        let mut raw = FAST.counts(&Sample {
            rate: AngularRate::from_dps(rate_dps),
            force: SpecificForce::from_g(truth.inverse() * Vector3::y()),
        });
        raw.gyro = gyro;
        if number == 0 {
            pair.reset(&raw);
        }
        worst = f64::max(worst, pair.update(&raw));
    }
    worst
}

#[test]
fn it_follows_the_reference_on_even_turns_without_noise() {
    for dps in [0.001, 0.01, 0.1, 1.0, -7.0, 90.0, 1000.0, 2300.0] {
        let worst = (0..9_u64)
            .map(|case| evenly(dps, case as usize % 3, about(case / 3)))
            .fold(0.0, f64::max);
        println!("{dps} degrees per second: {worst:.2e} degrees at most");
        assert!(worst <= ALLOWED, "{dps}: {worst:e} degrees");
    }
}
