//! What the gyro reads when nothing turns: found at rest, followed on the move, never learnt from a
//! turn.

use vrduino::fusion::{Fusion, Motion, Parameters, Source};

use crate::matrices::{Vector, degrees_between, length};
use crate::random::Random;
use crate::world::{Body, DT, dps, field, fusion, matrix, sample};

const BIAS: Vector = [0.017, -0.012, 0.02]; // about 1 °/s an axis

fn biased() -> Body {
    Body {
        bias: BIAS,
        ..Body::level()
    }
}

/// As noisy as the data sheet says: 0.14 °/s and 0.04 m/s².
fn feed(fusion: &mut Fusion<f64>, body: &mut Body, random: &mut Random, rate: Vector) {
    let (rate, force, _) = body.read(rate, [0.0; 3]);
    let noise = random.vector(0.14 * 1.7);
    let rate = [0, 1, 2].map(|i| rate[i] + noise[i].to_radians());
    let noise = random.vector(0.04 * 1.7);
    let force = [0, 1, 2].map(|i| force[i] + noise[i]);
    fusion.update(&sample(rate, force), None);
}

fn off(fusion: &Fusion<f64>) -> f64 {
    let found: Vector = fusion.bias().rate().rad_per_s().into();
    length([0, 1, 2].map(|i| found[i] - BIAS[i])).to_degrees()
}

#[test]
fn a_rest_of_three_seconds_tells_the_bias_to_a_hundredth() {
    let (mut fusion, mut body, mut random) = (fusion(&Parameters::default()), biased(), Random(1));
    assert_eq!(fusion.bias().source(), Source::Unmeasured);
    assert_eq!(fusion.residual(), None, "nobody can tell yet");
    for _ in 0..3000 {
        feed(&mut fusion, &mut body, &mut random, [0.0; 3]);
    }
    assert!(matches!(fusion.motion(), Motion::Still { samples } if samples > 1400));
    assert_eq!(fusion.bias().source(), Source::Rest { samples: 0 });
    assert!(off(&fusion) < 0.02, "{} °/s", off(&fusion));
    let residual = fusion.residual().expect("at rest").dps().norm() * 60.0;
    assert!(residual < 2.0, "{residual} °/min");
}

#[test]
fn a_rest_is_over_at_once_and_dated() {
    let (mut fusion, mut body, mut random) = (fusion(&Parameters::default()), biased(), Random(2));
    for _ in 0..3000 {
        feed(&mut fusion, &mut body, &mut random, [0.0; 3]);
    }
    for _ in 0..250 {
        feed(&mut fusion, &mut body, &mut random, dps([0.0, 30.0, 0.0]));
    }
    let Motion::Moving { samples } = fusion.motion() else {
        panic!("30 °/s are no rest");
    };
    assert!((240..=250).contains(&samples), "{samples}");
    assert!(matches!(fusion.bias().source(), Source::Rest { samples: s } if s == samples));
    assert_eq!(fusion.residual(), None);
    assert!(off(&fusion) < 0.02, "{} °/s", off(&fusion));
}

#[test]
fn on_the_move_tilt_tells_the_bias_slowly() {
    let (mut fusion, mut body, mut random) = (fusion(&Parameters::default()), biased(), Random(3));
    // It turns over and over, so that every axis is horizontal at times.
    for i in 0..60_000 {
        let t = f64::from(i) * DT;
        let rate = [(0.9 * t).sin(), (0.7 * t).cos(), (0.5 * t).sin()];
        feed(&mut fusion, &mut body, &mut random, rate);
    }
    assert_eq!(
        fusion.bias().source(),
        Source::Unmeasured,
        "it never rested"
    );
    assert!(
        off(&fusion) < 0.5 * length(BIAS).to_degrees(),
        "{} of {} °/s",
        off(&fusion),
        length(BIAS).to_degrees()
    );
}

#[test]
fn a_compass_tells_what_tilt_cannot_of_a_board_that_spins_upright() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = biased();
    for i in 0..40_000 {
        let t = f64::from(i) * DT;
        let (rate, force, m) = body.read(dps([0.0, 40.0 * t.sin(), 0.0]), [0.0; 3]);
        fusion.update(&sample(rate, force), Some(field(m)));
    }
    let off = (fusion.bias().rate().rad_per_s().y - BIAS[1]).to_degrees();
    assert!(off.abs() < 0.1, "{off} °/s");
}

#[test]
fn a_slow_steady_turn_is_not_learnt_once_the_bias_is_known() {
    let (mut fusion, mut body, mut random) = (fusion(&Parameters::default()), biased(), Random(4));
    for _ in 0..3000 {
        feed(&mut fusion, &mut body, &mut random, [0.0; 3]);
    }
    // A turntable: 3 °/s for a minute.
    for _ in 0..60_000 {
        feed(&mut fusion, &mut body, &mut random, dps([0.0, 3.0, 0.0]));
    }
    assert!(matches!(fusion.motion(), Motion::Moving { .. }));
    assert!(off(&fusion) < 0.03, "{} °/s", off(&fusion));
    let turned = degrees_between(&matrix(&fusion.orientation()), &body.attitude);
    // Learnt, it would be off by 180°.
    assert!(turned < 3.0, "{turned}°");
}

#[test]
fn a_wrong_bias_does_not_last_for_ever() {
    let (mut fusion, mut body, mut random) = (fusion(&Parameters::default()), biased(), Random(5));
    fusion.set_bias(vrduino::units::AngularRate::from_dps(
        nalgebra::Vector3::new(-4.0, 4.0, -4.0),
    ));
    for _ in 0..35_000 {
        feed(&mut fusion, &mut body, &mut random, [0.0; 3]);
    }
    assert!(matches!(fusion.motion(), Motion::Still { .. }));
    assert!(off(&fusion) < 0.02, "{} °/s", off(&fusion));
}

#[test]
fn a_bias_beyond_belief_is_a_turn() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = Body::level();
    body.bias = dps([0.0, 12.0, 0.0]);
    for _ in 0..60_000 {
        let (rate, force, _) = body.read([0.0; 3], [0.0; 3]);
        fusion.update(&sample(rate, force), None);
    }
    assert!(matches!(fusion.motion(), Motion::Moving { .. }));
    assert_eq!(fusion.bias().source(), Source::Unmeasured);
}

#[test]
fn a_slow_tilt_is_no_rest_for_the_force_turns_with_it() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = Body::level();
    for _ in 0..10_000 {
        let (rate, force, _) = body.read(dps([1.5, 0.0, 0.0]), [0.0; 3]);
        fusion.update(&sample(rate, force), None);
        assert!(matches!(fusion.motion(), Motion::Moving { .. }));
    }
    let off = degrees_between(&matrix(&fusion.orientation()), &body.attitude);
    assert!(off < 1.0, "{off}°");
}

#[test]
fn the_end_of_a_rest_does_not_count_for_it() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut body = biased();
    fusion.set_bias(vrduino::units::AngularRate::from_rad_per_s(BIAS.into()));
    let mut worst = 0.0;
    for i in 0..60_000 {
        // Ten times: two and a half seconds of rest, and a turn that sets out gently to 30 °/s, the same
        // way each time.
        let t = f64::from(i % 6000) * DT;
        let speed = match t {
            t if t < 2.5 => 0.0,
            t if t < 5.0 => 15.0 * (1.0 - (std::f64::consts::TAU * (t - 2.5) / 2.5).cos()),
            _ => 0.0,
        };
        let (rate, force, _) = body.read(dps([0.0, speed, 0.0]), [0.0; 3]);
        fusion.update(&sample(rate, force), None);
        if matches!(fusion.motion(), Motion::Moving { .. }) {
            worst = crate::matrices::larger(worst, off(&fusion));
        }
    }
    assert!(worst < 0.01, "{worst} °/s");
}

#[test]
fn what_can_be_no_bias_is_not_taken_for_one() {
    let mut fusion = fusion::<f64>(&Parameters::default());
    for bad in [f64::NAN, f64::INFINITY, 1.0] {
        let rate =
            vrduino::units::AngularRate::from_rad_per_s(nalgebra::Vector3::new(0.0, bad, 0.0));
        assert!(!fusion.set_bias(rate) && !fusion.guess_bias(rate));
    }
    assert_eq!(fusion.bias().source(), Source::Unmeasured);
    assert_eq!(fusion.bias().rate().rad_per_s().norm(), 0.0);
}
