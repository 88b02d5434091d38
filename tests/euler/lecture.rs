//! The trackers of the 2016 lecture, and where they fail.

use super::*;

/// Where the lecture's dead reckoning and that of the notes end, in degrees from the truth.
fn reckoned(start: EulerAngles<f64>, rate_dps: [f64; 3], seconds: f64) -> (f64, f64) {
    let (rate, dt) = (rate_dps.map(f64::to_radians), 0.001);
    let mut lecture = LectureDeadReckoning::new(Seconds(dt));
    lecture.set(start);
    let mut notes = DeadReckoning::new(Seconds(dt));
    notes.set(start.orientation());
    for _ in 0..(seconds / dt).round() as u32 {
        let reading = reading(&matrix(start), rate);
        lecture.update(&reading);
        notes.update(&reading);
    }
    let truth = product(&matrix(start), &turn(rate, seconds));
    (
        degrees_between(&matrix(lecture.angles()), &truth),
        degrees_between(&columns(notes.orientation()), &truth),
    )
}

#[test]
fn the_lectures_dead_reckoning_is_right_for_one_axis_and_wrong_for_two() {
    // One axis at a time, from level: all is well.
    for axis in 0..3 {
        let mut rate = [0.0; 3];
        rate[axis] = 70.0;
        let (lecture, notes) = reckoned(EulerAngles::zero(), rate, 1.0);
        assert!(lecture < 1e-9 && notes < 1e-9);
    }
    // Rolled by 90°, ω_x is yaw: 120° off after a quarter turn. Rolled by 10°: 3.5° after 20°.
    for (roll, dps, off) in [(90.0, 90.0, 120.0), (10.0, 20.0, 3.5)] {
        let (lecture, notes) = reckoned(degrees(0.0, 0.0, roll), [dps, 0.0, 0.0], 1.0);
        assert!((lecture - off).abs() < 0.05, "{lecture}");
        assert!(notes < 1e-9, "{notes}");
    }
    // And the truth of the first is a yaw of 90°.
    let turned = product(
        &matrix(degrees(0.0, 0.0, 90.0)),
        &turn([FRAC_PI_2, 0.0, 0.0], 1.0),
    );
    assert!(degrees_between(&turned, &matrix(degrees(90.0, 0.0, 90.0))) < 1e-9);
}

/// Largest error in degrees of the lecture's filter and of the notes', fed by perfect sensors.
fn filtered(start: EulerAngles<f64>, seconds: f64, rate: impl Fn(f64) -> [f64; 3]) -> (f64, f64) {
    let dt = 0.001;
    let time_constant = TimeConstant::new(Seconds(0.5));
    let mut lecture = LectureComplementary::new(time_constant, Seconds(dt));
    lecture.set(start);
    let mut notes = Complementary::new(time_constant, Seconds(dt));
    notes.set(start.orientation());
    let mut truth = matrix(start);
    let mut worst = (0.0_f64, 0.0_f64);
    for k in 0..(seconds / dt).round() as u32 {
        let rate = rate((f64::from(k) + 0.5) * dt);
        truth = product(&truth, &turn(rate, dt));
        let reading = reading(&truth, rate);
        let found = matrix(lecture.update(&reading));
        worst.0 = worst.0.max(degrees_between(&found, &truth));
        let found = columns(notes.update(&reading));
        worst.1 = worst.1.max(degrees_between(&found, &truth));
    }
    worst
}

#[test]
fn the_lectures_filter_fails_when_axes_turn_together_and_the_quaternion_filter_does_not() {
    // A rolled head shakes: far from gimbal lock, and the accelerometer corrects pitch and roll.
    let shake = |t: f64| [0.0, 2.0 * (3.0 * t).sin(), 0.0];
    let (lecture, notes) = filtered(degrees(0.0, 0.0, 30.0), 10.0, shake);
    assert!((lecture - 19.0).abs() < 0.05, "{lecture}");
    assert!(notes < 1e-6, "{notes}");
    // Nodding and tilting a quarter of a period apart, as one does when listening to music: yaw,
    // which nothing corrects, walks away.
    let nod = |t: f64| [2.0 * (4.0 * t).sin(), 0.0, 2.0 * (4.0 * t).cos()];
    let (lecture, notes) = filtered(EulerAngles::zero(), 20.0, nod);
    assert!((lecture - 180.0).abs() < 0.05, "{lecture}");
    assert!(notes < 1e-6, "{notes}");
}

#[test]
fn the_lectures_filter_fails_at_gimbal_lock_and_the_quaternion_filter_does_not() {
    // Looking up and over: pitch passes 90° at 60 °/s, nothing else turns.
    let up = |_: f64| [60.0_f64.to_radians(), 0.0, 0.0];
    let (lecture, notes) = filtered(EulerAngles::zero(), 3.0, up);
    assert!((lecture - 175.7).abs() < 0.05, "{lecture}");
    assert!(notes < 1e-6, "{notes}");
    // Up to 80° only, the same filter is right.
    let (lecture, _) = filtered(EulerAngles::zero(), 80.0 / 60.0, up);
    assert!(lecture < 1e-6, "{lecture}");
}

/// The slide as printed: degrees, no wrapping, eq. 11 with the sign beside eq. 12.
fn printed([pitch, roll]: [f64; 2], dps: [f64; 3], a: [f64; 3], alpha: f64, dt: f64) -> [f64; 2] {
    let [x, y, z] = a;
    let by_accelerometer = [
        -z.atan2(y.signum() * (x * x + y * y).sqrt()).to_degrees(),
        -(-x).atan2(y).to_degrees(),
    ];
    [
        alpha * (pitch + dps[0] * dt) + (1.0 - alpha) * by_accelerometer[0],
        alpha * (roll + dps[2] * dt) + (1.0 - alpha) * by_accelerometer[1],
    ]
}

#[test]
fn the_lectures_filter_is_that_of_the_slide_where_the_slide_is_consistent() {
    let (alpha, dt) = (0.9, 0.01);
    let weight = TimeConstant::from_gyro_weight(alpha, Seconds(dt));
    let mut library = LectureComplementary::new(weight, Seconds(dt));
    let mut slide = [0.0; 2];
    let mut yaw = 0.0;
    for k in 0..2000 {
        let t = f64::from(k) * dt;
        // A board that stays upright: a_y > 0.
        let board = degrees(3.0 * t, 40.0 * t.sin(), 50.0 * (0.7 * t).cos());
        let dps = [30.0 * t.cos(), 20.0 * t.sin(), -25.0 * t.sin()];
        let reading = reading(&matrix(board), dps.map(f64::to_radians));
        let found = library.update(&reading);
        let force = reading.force().m_per_s2();
        slide = printed(slide, dps, force.into(), alpha, dt);
        yaw += dps[1] * dt;
        assert!((found.pitch.degrees() - slide[0]).abs() < 1e-9);
        assert!((found.roll.degrees() - slide[1]).abs() < 1e-9);
        assert!((found.yaw.degrees() - yaw).abs() < 1e-9);
    }
}

#[test]
fn the_slide_as_printed_settles_on_another_board_and_the_library_does_not() {
    // At rest at pitch 10° and roll 170° (a_y < 0), from a start at zero.
    let board = matrix(degrees(0.0, 10.0, 170.0));
    let reading = reading(&board, [0.0; 3]);
    let weight = TimeConstant::from_gyro_weight(0.9, Seconds(0.01));
    let mut library = LectureComplementary::new(weight, Seconds(0.01));
    let mut slide = [0.0; 2];
    for _ in 0..1000 {
        library.update(&reading);
        let force = reading.force().m_per_s2();
        slide = printed(slide, [0.0; 3], force.into(), 0.9, 0.01);
    }
    assert!((slide[0] - 170.0).abs() < 1e-9 && (slide[1] - 170.0).abs() < 1e-9);
    assert!(degrees_between(&matrix(library.angles()), &board) < 1e-9);
    assert!(degrees_between(&matrix(degrees(0.0, slide[0], slide[1])), &board) > 150.0);
    // And across the seam: from 179°, shown −179°.
    library.set(degrees(0.0, 0.0, 179.0));
    let across = self::reading(&matrix(degrees(0.0, 0.0, -179.0)), [0.0; 3]);
    assert!((library.update(&across).roll.degrees() - 179.2).abs() < 1e-9);
    let force = across.force().m_per_s2();
    let slide = printed([0.0, 179.0], [0.0; 3], force.into(), 0.9, 0.01);
    assert!((slide[1] - 143.2).abs() < 1e-9);
}

#[test]
fn no_input_makes_the_lectures_trackers_anything_but_angles() {
    for dt in ODD {
        for tau in ODD {
            let time_constant = TimeConstant::new(Seconds(tau));
            let mut filter = LectureComplementary::new(time_constant, Seconds(dt));
            let mut gyro = LectureDeadReckoning::new(Seconds(dt));
            filter.set(angles(tau, dt, 1.0));
            gyro.set(angles(1.0, tau, dt));
            for a in ODD {
                for b in ODD {
                    let reading = GyroBias::zero().correct(Sample {
                        rate: AngularRate::from_rad_per_s(Vector3::new(a, b, 1.0)),
                        force: SpecificForce::from_m_per_s2(Vector3::new(b, 1.0, a)),
                    });
                    for angles in [filter.update(&reading), gyro.update(&reading)] {
                        assert!(radians(angles).iter().all(|a| a.abs() <= PI + 1e-9));
                    }
                }
            }
        }
    }
}
