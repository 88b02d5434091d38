//! Whatever it is fed, flatland stays on the circle.

use super::*;

#[test]
fn alpha_outside_0_to_1_counts_as_the_nearer_end() {
    for (alpha, fused) in [
        (f64::NEG_INFINITY, 0.4),
        (-1e300, 0.4),
        (-0.5, 0.4),
        (0.0, 0.4),
        (1.0, 0.1),
        (1.5, 0.1),
        (f64::INFINITY, 0.1),
        (f64::NAN, 0.1),
    ] {
        let mut flat = filter(alpha, 0.01);
        let roll = flat.update(&reading(10.0, tilted(0.4)));
        assert!(
            (roll.fused.rad() - fused).abs() < 1e-12,
            "{alpha}: {roll:?}"
        );
    }
    // However far outside, and at any period.
    fn far<T: RealField + Copy>() {
        for exponent in -30..=30 {
            for period in [1e-4, 0.001, 0.0033, 0.01, 1.0 / 3.0] {
                let (far, period) = (10.0_f64.powi(exponent), Seconds(convert::<f64, T>(period)));
                for far in [far, f64::INFINITY] {
                    let weight = |alpha: f64| {
                        TimeConstant::from_gyro_weight(convert::<f64, T>(alpha), period)
                            .gyro_weight(period)
                    };
                    assert_eq!(weight(-far), T::zero(), "-{far}");
                    assert_eq!(weight(1.0 + far), T::one(), "1 + {far}");
                }
            }
        }
    }
    far::<f32>();
    far::<f64>();
}

#[test]
fn no_time_no_turn_and_no_input_leaves_the_circle() {
    let mut still = filter(0.9, 0.0);
    still.start_at(Angle::from_rad(0.3));
    assert_eq!(still.update(&reading(1e9, tilted(0.3))).gyro.rad(), 0.3);
    for dt in ODD {
        for tau in ODD {
            let mut flat = Flatland::new(TimeConstant::new(Seconds(tau)), Seconds(dt));
            for rate in ODD {
                for x in ODD {
                    for y in ODD {
                        let roll = flat.update(&reading(rate, [x, y, 0.0]));
                        for angle in [roll.gyro, roll.accelerometer, roll.fused] {
                            assert!(angle.rad().abs() <= PI + 1e-9);
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn what_is_not_finite_turns_nothing_and_corrects_nothing() {
    let after = |rate, force| {
        let mut flat = filter(0.9, 0.01);
        flat.start_at(Angle::from_rad(0.4));
        let roll = flat.update(&reading(rate, force));
        [roll.gyro, roll.accelerometer, roll.fused].map(|angle| angle.rad())
    };
    let near = |is: [f64; 3], expected: [f64; 3]| {
        let pairs = is.into_iter().zip(expected);
        assert!(
            pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12),
            "{is:?}"
        );
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        near(after(bad, tilted(0.5)), [0.4, 0.5, 0.41]);
        near(after(1.0, [bad, G, 0.0]), [0.41, 0.4, 0.41]);
        near(after(bad, [0.0, bad, 0.0]), [0.4; 3]);
    }
    // Free fall.
    near(after(1.0, [0.0; 3]), [0.41, 0.4, 0.41]);
}

fn huge_turns_stay_on_the_circle<T: RealField + Copy>(largest_exponent: f64) {
    let mut random = Random(4);
    for _ in 0..2_000_000 {
        let turn: T = convert(10.0_f64.powf(random.between(0.0, largest_exponent)));
        let (zero, angle) = (Angle::from_rad(T::zero()), Angle::from_rad(turn));
        assert!(shortest_turn(zero, angle).rad().abs() <= T::pi());
        assert!(shortest_turn(angle, zero).rad().abs() <= T::pi());
    }
}

#[test]
fn turns_of_any_size_stay_on_the_circle() {
    huge_turns_stay_on_the_circle::<f64>(308.0);
    huge_turns_stay_on_the_circle::<f32>(38.0);
}
