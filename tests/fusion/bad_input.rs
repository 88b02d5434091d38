//! Whatever comes in, a finite unit quaternion comes out, and soon a right one again.

use nalgebra::{RealField, Vector3, convert};
use vrduino::fusion::{Fusion, Parameters, Rates};
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, MagneticField, Seconds, SpecificForce};

use crate::matrices::degrees_between;
use crate::random::Random;
use crate::world::{Body, DT, dps, field, fusion, matrix, sample};

const ODD: [f64; 14] = [
    0.0,
    -0.0,
    1e-300,
    1e-30,
    1.0,
    -9.81,
    34.9,
    -160.0,
    1e4,
    1e30,
    -1e300,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

fn odd<T: RealField + Copy>(random: &mut Random) -> Vector3<T> {
    let pick = |random: &mut Random| {
        let index = (random.unit() * ODD.len() as f64) as usize;
        convert::<f64, T>(ODD[index])
    };
    Vector3::from_fn(|_, _| pick(random))
}

fn is_a_rotation<T: RealField + Copy>(fusion: &Fusion<T>) {
    for q in [fusion.orientation(), fusion.estimate()] {
        let norm: f64 = nalgebra::try_convert(q.norm()).unwrap_or(f64::NAN);
        assert!((norm - 1.0).abs() < 1e-5, "{norm}");
    }
    let bias = fusion.bias().rate().rad_per_s();
    assert!(
        bias.iter().all(|component| component.is_finite()),
        "{bias:?}"
    );
}

fn survives<T: RealField + Copy>() {
    let mut random = Random(6);
    for _ in 0..2_000 {
        let parameters = Parameters {
            lead: Seconds(convert(random.between(-1.0, 1.0))),
            ..Parameters::<T>::default()
        };
        let mut fusion = fusion(&parameters);
        for _ in 0..500 {
            let sample = Sample {
                rate: AngularRate::from_rad_per_s(odd(&mut random)),
                force: SpecificForce::from_m_per_s2(odd(&mut random)),
            };
            let field = MagneticField::from_microtesla(odd(&mut random));
            fusion.update(&sample, (random.unit() < 0.5).then_some(field));
            is_a_rotation(&fusion);
        }
    }
}

#[test]
fn a_million_odd_samples_leave_a_rotation_in_double_precision() {
    survives::<f64>();
}

#[test]
fn a_million_odd_samples_leave_a_rotation_in_single_precision() {
    survives::<f32>();
}

#[test]
fn odd_parameters_and_periods_leave_a_rotation() {
    let mut random = Random(7);
    let pick = |random: &mut Random| ODD[(random.unit() * ODD.len() as f64) as usize];
    for _ in 0..20_000 {
        let mut odd = || pick(&mut random);
        let parameters = Parameters {
            tilt_time: Seconds(odd()),
            damping: odd(),
            lead: Seconds(odd()),
            start_time: Seconds(odd()),
            tilt_integral: odd(),
            tilt_integral_start: Seconds(odd()),
            rest_filter_time: Seconds(odd()),
            rest_time: Seconds(odd()),
            rest_rate_dps: odd(),
            rest_force: odd(),
            largest_bias_dps: odd(),
            rest_bias_dps: odd(),
            largest_change_dps: odd(),
            heading_time: Seconds(odd()),
            heading_integral: odd(),
            heading_integral_start: odd(),
            rest_worth: Seconds(odd()),
            field_tolerance: odd(),
            field_time: Seconds(odd()),
            new_field_time: [Seconds(odd()), Seconds(odd())],
        };
        let rates = Rates {
            sample: Seconds(odd()),
            field: Seconds(odd()),
        };
        let mut fusion = Fusion::<f64>::new(&parameters, rates);
        for _ in 0..50 {
            let rate = random.vector(5.0);
            let force = random.vector(20.0);
            fusion.update(&sample(rate, force), Some(field(random.vector(60.0))));
            is_a_rotation(&fusion);
        }
    }
}

#[test]
fn what_is_no_measurement_is_counted_and_changes_nothing() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = Body::level();
    for _ in 0..2000 {
        let (rate, force, _) = body.read(dps([10.0, 20.0, 30.0]), [0.0; 3]);
        fusion.update(&sample(rate, force), None);
    }
    let before = fusion.orientation();
    for bad in [f64::NAN, f64::INFINITY, 1e9] {
        fusion.update(&sample([bad, 0.0, 0.0], [0.0, 9.81, 0.0]), None);
        fusion.update(&sample([0.0; 3], [0.0, bad, 0.0]), None);
    }
    assert_eq!(fusion.refused(), 6);
    assert_eq!(fusion.orientation(), before);
}

#[test]
fn after_a_saturated_gyro_tilt_is_right_again_within_seconds() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = Body::level();
    let saturated = 2000_f64.to_radians();
    for i in 0..20_000 {
        let t = f64::from(i) * DT;
        let true_rate = if (5.0..5.1).contains(&t) {
            // A knock of 3000 °/s about x, of which the gyro shows 2000.
            dps([3000.0, 0.0, 0.0])
        } else {
            dps([0.0, 20.0 * t.sin(), 0.0])
        };
        let (rate, force, _) = body.read(true_rate, [0.0; 3]);
        let clipped = rate.map(|rate| rate.clamp(-saturated, saturated));
        fusion.update(&sample(clipped, force), None);
        if i == 5100 {
            let off = degrees_between(&matrix(&fusion.orientation()), &body.attitude);
            assert!(off > 90.0, "{off}°: it has lost its way");
        }
    }
    let up = |m: crate::matrices::Matrix| m[1];
    let (a, b) = (up(matrix(&fusion.orientation())), up(body.attitude));
    let apart = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    // 3°.
    assert!(apart < 0.05, "{apart}");
}

#[test]
fn free_fall_is_bridged_by_the_gyro() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = Body::level();
    for i in 0..6000 {
        let falling = i >= 3000;
        let push = if falling { [0.0, -9.81, 0.0] } else { [0.0; 3] };
        let (rate, force, _) = body.read(dps([40.0, 30.0, 20.0]), push);
        fusion.update(&sample(rate, force), None);
    }
    let off = degrees_between(&matrix(&fusion.orientation()), &body.attitude);
    assert!(off < 0.5, "{off}°");
}
