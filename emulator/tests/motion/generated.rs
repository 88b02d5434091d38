//! The head, scripted turns, and the imperfections of a sensor.

use std::f64::consts::FRAC_PI_2;

use vrduino_emulator::motion::rotation::{
    IDENTITY, about, angle_between, gravity_in_body, multiply, rotate,
};
use vrduino_emulator::motion::{self, Head, Imperfect, Imperfections, Motion, MotionError, Turns};

use crate::{close, length};

/// Follows a motion by its angular rate alone and returns the largest angle to its truth (°).
fn drift(motion: &dyn Motion, seconds: f64) -> f64 {
    const STEP: f64 = 0.001;
    let mut attitude = motion.at(0.0).truth.unwrap();
    let mut worst: f64 = 0.0;
    for step in 0..(seconds / STEP).round() as u32 {
        let t = f64::from(step) * STEP;
        let rate = motion.at(t + STEP / 2.0).rate;
        let speed = length(rate);
        if speed > 0.0 {
            let turn = about(rate.map(|c| c / speed), speed * STEP);
            attitude = multiply(attitude, turn);
        }
        let truth = motion.at(t + STEP).truth.unwrap();
        worst = worst.max(angle_between(attitude, truth).to_degrees());
    }
    worst
}

#[test]
fn the_head_motion_turns_as_its_rate_says() {
    assert!(drift(&Head::new(), 20.0) < 0.01);
}

#[test]
fn the_head_motion_begins_level_and_still() {
    for t in [0.0, 1.7, 3.0] {
        let instant = Head::new().at(t);
        assert_eq!(instant.rate, [0.0; 3]);
        assert!(close(instant.force, [0.0, 9.81, 0.0], 1e-12));
        assert_eq!(instant.truth.unwrap()[0], 1.0);
    }
}

#[test]
fn the_head_motion_feels_gravity_and_stays_in_its_range() {
    let head = Head::new();
    let (mut fastest, mut furthest): (f64, f64) = (0.0, 0.0);
    for step in 0..60_000 {
        let instant = head.at(f64::from(step) * 0.002);
        let truth = instant.truth.unwrap();
        assert!(close(instant.force, gravity_in_body(truth), 1e-9));
        fastest = fastest.max(length(instant.rate).to_degrees());
        // Where the sensor's −z axis, the direction of view, points to the side.
        let view = rotate(truth, [0.0, 0.0, -1.0]);
        furthest = furthest.max(view[0].atan2(-view[2]).abs().to_degrees());
    }
    assert!((150.0..=250.0).contains(&fastest), "{fastest} °/s");
    assert!((45.0..=60.0).contains(&furthest), "{furthest}°");
}

#[test]
fn a_lever_arm_adds_the_acceleration_of_the_carried_sensor() {
    let head = Head {
        lever_arm: Head::ON_THE_NECK,
    };
    let step = 1e-3;
    let place = |t: f64| rotate(head.at(t).truth.unwrap(), Head::ON_THE_NECK);
    let (before, now, after) = (place(9.0 - step), place(9.0), place(9.0 + step));
    let expected: [f64; 3] = std::array::from_fn(|i| {
        let gravity = if i == 1 { 9.81 } else { 0.0 };
        (before[i] - 2.0 * now[i] + after[i]) / (step * step) + gravity
    });
    let instant = head.at(9.0);
    let felt = rotate(instant.truth.unwrap(), instant.force);
    assert!(close(felt, expected, 1e-4), "{felt:?} {expected:?}");
    assert!(!close(felt, [0.0, 9.81, 0.0], 0.05));
}

#[test]
fn imperfections_are_the_same_however_the_motion_is_sampled() {
    let imperfect = || Imperfect::new(Box::new(Head::new()), Imperfections::default());
    let forward = imperfect();
    let seen: Vec<_> = (0..100).map(|i| forward.at(f64::from(i) * 0.01)).collect();
    let backward = imperfect();
    for i in (0..100).rev() {
        assert_eq!(backward.at(f64::from(i) * 0.01), seen[i as usize]);
    }
}

#[test]
fn imperfections_have_the_size_they_say() {
    let imperfections = Imperfections {
        seed: 7,
        ..Imperfections::default()
    };
    let motion = Imperfect::new(Box::new(Turns::new(60.0, 0.0)), imperfections);
    let samples: Vec<_> = (0..50_000)
        .map(|i| motion.at(f64::from(i) * 0.001))
        .collect();
    let statistics = |values: Vec<f64>| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        (mean, (square / values.len() as f64).sqrt())
    };
    for (axis, bias) in imperfections.gyro_bias_dps.into_iter().enumerate() {
        let (mean, rms) = statistics(samples.iter().map(|s| s.rate[axis].to_degrees()).collect());
        assert!((mean - bias).abs() < 0.003, "{mean}");
        assert!((rms - 0.1).abs() < 0.002, "{rms}");
        let (mean, rms) = statistics(samples.iter().map(|s| s.force[axis]).collect());
        assert!((mean - [0.0, 9.81, 0.0][axis]).abs() < 0.001, "{mean}");
        assert!((rms - 0.03).abs() < 0.001, "{rms}");
    }
    assert_eq!(samples[0].truth, Some(IDENTITY));
}

#[test]
fn scripted_turns_end_where_they_should() {
    let turns =
        Turns::new(2.0, 0.5)
            .turn([0.0, 3.0, 0.0], 90.0, 1.0)
            .turn([1.0, 0.0, 0.0], -30.0, 0.5);
    assert_eq!(turns.duration(), Some(4.5));
    assert_eq!(turns.at(1.9).rate, [0.0; 3]);
    assert_eq!(turns.at(3.2).rate, [0.0; 3]);
    assert!((turns.at(2.5).rate[1].to_degrees() - 180.0).abs() < 1e-9);
    let expected = multiply(
        about([0.0, 1.0, 0.0], FRAC_PI_2),
        about([1.0, 0.0, 0.0], (-30.0_f64).to_radians()),
    );
    let end = turns.at(99.0);
    assert!(angle_between(end.truth.unwrap(), expected) < 1e-9);
    assert!(close(end.force, gravity_in_body(expected), 1e-9));
    assert!(drift(&turns, 5.0) < 0.001);
}

#[test]
fn a_motion_can_begin_later() {
    let script = || Box::new(Turns::new(0.0, 0.0).turn([0.0, 0.0, 1.0], 45.0, 2.0));
    let later = motion::skip(script(), 0.5).unwrap();
    assert_eq!(later.at(0.25), script().at(0.75));
    assert_eq!(later.duration(), Some(1.5));
    for start in [2.0, 1e300, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            motion::skip(script(), start),
            Err(MotionError::Start { .. })
        ));
    }
    assert!(motion::skip(Box::new(Head::new()), 1e6).is_ok());
}
