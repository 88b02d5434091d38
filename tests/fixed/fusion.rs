//! The default estimator in integers beside the one in double precision, on the same counts.

use crate::motion::{Motion, PERIOD};
use crate::random::Random;
use crate::reference::{FAST, about, degrees_apart};
use vrduino::fixed::fusion::{Field, Force, Fusion, Nanoseconds, Parameters, Rates};
use vrduino::fusion;
use vrduino::imu::RANGES;
use vrduino::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use vrduino::sensor::{AccelRange, GyroRange, Ranges, RawSample};
use vrduino::units::{AngularRate, MagneticField, Seconds};

const SEEDS: u64 = 12;
/// A field comes with every tenth sample.
const FIELD: usize = 10;
/// What the integers may be off by, in degrees: six axes, slow motion without noise, and nine axes in the
/// compass's first ten seconds and after.
const SIX_AXES: f64 = 0.002;
const SLOW: f64 = 0.004;
const NINE_AXES: [f64; 2] = [0.01, 0.004];

pub fn unit(bits: [i32; 4]) -> UnitQuaternion<f64> {
    let [w, x, y, z] = bits.map(|bits| f64::from(bits) / f64::from(1 << 30));
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

pub fn rates(ranges: Ranges) -> Rates {
    Rates {
        sample: Nanoseconds(1_000_000),
        field: Nanoseconds(10_000_000),
        ranges,
    }
}

/// Both estimators.
struct Pair {
    ranges: Ranges,
    fixed: Fusion,
    reference: fusion::Fusion<f64>,
}

impl Pair {
    fn new(ranges: Ranges, lead: f64) -> Self {
        let parameters = Parameters {
            lead: Seconds(lead as f32),
            ..Parameters::default()
        };
        let in_double_precision = fusion::Parameters {
            lead: Seconds(lead),
            ..fusion::Parameters::default()
        };
        let periods = fusion::Rates {
            sample: Seconds(PERIOD),
            field: Seconds(PERIOD * FIELD as f64),
        };
        Self {
            ranges,
            fixed: Fusion::new(&parameters, rates(ranges)),
            reference: fusion::Fusion::new(&in_double_precision, periods),
        }
    }

    /// Both take the sample; how far apart they are then, in degrees.
    fn update(&mut self, raw: &RawSample, field: Option<[i32; 3]>) -> f64 {
        let microtesla = |field: [i32; 3]| {
            let parts = Vector3::from(field.map(|part| f64::from(part) / 32768.0));
            MagneticField::from_microtesla(parts)
        };
        self.fixed
            .update(raw, field.map(Field::from_parts_of_microtesla));
        self.reference
            .update(&self.ranges.sample(raw), field.map(microtesla));
        self.apart()
    }

    fn apart(&self) -> f64 {
        degrees_apart(self.reference.orientation(), unit(self.fixed.bits()))
    }
}

/// The largest difference of so many samples without a field.
fn worst(motion: &mut Motion, samples: usize) -> f64 {
    let mut pair = Pair::new(motion.ranges, 0.0);
    (0..samples)
        .map(|_| pair.update(&motion.next(), None))
        .fold(0.0, f64::max)
}

fn check(name: &str, allowed: f64, worst: impl Fn(u64) -> f64) {
    let worst = (1..=SEEDS).map(worst).fold(0.0, f64::max);
    println!("{name}: {worst:.2e} degrees at most");
    assert!(worst <= allowed, "{name}: {worst:e} degrees");
}

/// A bias that a rest is believed to show.
fn small_bias(seed: u64) -> [f64; 3] {
    Random(seed * 13 + 7).vector(1.2)
}

#[test]
fn it_follows_the_reference_from_a_rest_into_motion() {
    for dps in [30.0, 300.0, 1500.0] {
        check(&format!("{dps} °/s"), SIX_AXES, |seed| {
            let mut motion = Motion::new(seed, RANGES, about(seed), dps, 2.0);
            motion.bias_dps = small_bias(seed);
            motion.still = 4000;
            worst(&mut motion, 30_000)
        });
    }
}

#[test]
fn it_follows_the_reference_where_nothing_rests() {
    check("in motion from the first sample", SIX_AXES, |seed| {
        let mut motion = Motion::new(seed, RANGES, about(seed), 200.0, 1.0);
        motion.bias_dps = small_bias(seed);
        worst(&mut motion, 30_000)
    });
}

#[test]
fn it_follows_the_reference_in_every_range() {
    for gyro in GyroRange::ALL {
        for accel in AccelRange::ALL {
            let ranges = Ranges { gyro, accel };
            let worst = (1..=4)
                .map(|seed| {
                    let mut motion =
                        Motion::new(seed, ranges, about(seed), gyro.max_dps() / 3.0, 2.0);
                    motion.bias_dps = small_bias(seed);
                    motion.still = 3000;
                    worst(&mut motion, 20_000)
                })
                .fold(0.0, f64::max);
            println!("{ranges:?}: {worst:.2e} degrees at most");
            assert!(worst <= SIX_AXES, "{ranges:?}: {worst:e} degrees");
        }
    }
}

/// Nothing dithers, so that whatever is rounded is rounded the same way again and again.
#[test]
fn it_follows_the_reference_on_slow_motion_without_noise() {
    for (dps, hertz) in [(0.0, 1.0), (0.5, 0.01), (5.0, 0.02), (20.0, 0.05)] {
        for ranges in [RANGES, FAST] {
            check(&format!("{dps} °/s, {ranges:?}"), SLOW, |seed| {
                let mut motion = Motion::new(seed, ranges, about(seed), dps, hertz);
                motion.bias_dps = small_bias(seed);
                motion.noise = 0.0;
                motion.still = 100 * seed as usize;
                worst(&mut motion, 60_000)
            });
        }
    }
}

#[test]
fn it_follows_the_reference_for_minutes() {
    let mut motion = Motion::new(3, RANGES, about(3), 150.0, 0.7);
    motion.bias_dps = small_bias(3);
    let worst = worst(&mut motion, 600_000);
    println!("ten minutes: {worst:.2e} degrees at most");
    assert!(worst <= SIX_AXES, "{worst:e} degrees");
}

#[test]
fn it_follows_the_reference_with_a_compass() {
    for still in [0, 4000] {
        let mut largest = [0.0_f64; 2];
        for seed in 1..=SEEDS {
            let mut motion = Motion::new(seed, RANGES, about(seed), 120.0, 0.7);
            motion.bias_dps = small_bias(seed);
            motion.still = still;
            let mut pair = Pair::new(RANGES, 0.0);
            for number in 0..40_000 {
                let raw = motion.next();
                let field = (number % FIELD == 0).then(|| motion.field());
                let after = usize::from(number >= 10_000);
                largest[after] = largest[after].max(pair.update(&raw, field));
            }
            assert_eq!(pair.fixed.field_verdict(), pair.reference.field_verdict());
        }
        println!("{largest:?} degrees at most at the start and after");
        assert!(
            largest[0] <= NINE_AXES[0] && largest[1] <= NINE_AXES[1],
            "{largest:?}"
        );
    }
}

#[test]
fn a_lead_is_that_of_the_reference() {
    for lead in [0.0025, 0.02, 0.1] {
        let mut motion = Motion::new(5, FAST, about(5), 1990.0, 1.0);
        let mut pair = Pair::new(FAST, lead);
        let worst = (0..5000)
            .map(|_| pair.update(&motion.next(), None))
            .fold(0.0, f64::max);
        assert!(worst <= SIX_AXES, "{lead}: {worst:e} degrees");
    }
}

#[test]
fn what_it_is_told_it_takes_like_the_reference() {
    let mut motion = Motion::new(9, RANGES, about(9), 60.0, 0.5);
    motion.bias_dps = small_bias(9);
    motion.still = 2500;
    let mut pair = Pair::new(RANGES, 0.0);
    for number in 0..30_000 {
        let raw = motion.next();
        let force = Force::from_counts(raw.accel);
        let in_units = pair.ranges.sample::<f64>(&raw);
        match number {
            6000 => {
                pair.fixed.reset(force);
                pair.reference.reset(in_units.force);
                let [w, _, y, _] = pair.fixed.estimate();
                assert!(w > 0 && y.abs() < 40, "it looks ahead: {w} {y}");
            }
            9000 => {
                pair.fixed.level(force);
                pair.reference.level(in_units.force);
            }
            12_000 => {
                let to = UnitQuaternion::from_euler_angles(0.3, -1.0, 0.2);
                let parts = [to.w, to.i, to.j, to.k].map(|part| (part * 1_073_741_824.0) as i32);
                assert!(pair.fixed.set(parts));
                pair.reference.set(to);
            }
            15_000 => {
                let bias = Vector3::new(0.5, -0.25, 0.125);
                assert!(
                    pair.fixed
                        .set_bias(AngularRate::from_dps(bias.cast::<f32>()))
                );
                assert!(pair.reference.set_bias(AngularRate::from_dps(bias)));
            }
            18_000 => {
                let period = 1_010_000;
                pair.fixed.set_sample_period(Nanoseconds(period));
                pair.reference
                    .set_sample_period(Seconds(f64::from(period) * 1e-9));
            }
            _ => {}
        }
        let apart = pair.update(&raw, None);
        assert!(apart <= SIX_AXES, "{number}: {apart:e} degrees");
        assert_eq!(pair.fixed.motion(), pair.reference.motion(), "{number}");
        assert_eq!(
            pair.fixed.bias().source(),
            pair.reference.bias().source(),
            "{number}"
        );
        let residuals = (pair.fixed.residual(), pair.reference.residual());
        if let (Some(found), Some(expected)) = residuals {
            let off = (found.dps().cast::<f64>() - expected.dps()).amax();
            assert!(off < 1e-4, "{number}: {off:e} °/s");
        }
        let found = pair.fixed.bias().rate().dps().cast::<f64>();
        let off = (found - pair.reference.bias().rate().dps()).amax();
        assert!(off < 1e-4, "{number}: {off:e} °/s");
    }
}

#[test]
fn what_can_be_no_bias_is_not_taken_for_one() {
    let mut fusion = Fusion::new(&Parameters::default(), rates(RANGES));
    for bad in [f32::NAN, f32::INFINITY, 11.0] {
        let rate = AngularRate::from_dps(Vector3::new(0.0, bad, 0.0));
        assert!(!fusion.set_bias(rate) && !fusion.guess_bias(rate));
    }
    assert_eq!(fusion.bias().rate(), AngularRate::zero());
    assert!(!fusion.set([0, 1, 2, 3]));
    assert_eq!(fusion.estimate(), [1 << 30, 0, 0, 0]);
}
