//! What the sensor is turned through is found in the stream.

use vrduino_emulator::board::Setup;
use vrduino_emulator::motion::rotation::multiply;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::motion::{self, Motion};
use vrduino_emulator::mpu9250::Part;
use vrduino_emulator::time::{self, SECOND};

use crate::run::{PRINTED, Run, X, Y, Z, degrees_between};

#[test]
fn a_still_start_gives_the_first_orientation_within_three_seconds_and_a_hundred_lines_a_second() {
    let mut run = Run::still();
    run.seconds(4.0);
    let first = run.orientations[0].0;
    assert!(first < 3.0, "first QC at {first} s");
    for second in 2..4 {
        let span = f64::from(second)..f64::from(second + 1);
        let lines = run
            .orientations
            .iter()
            .filter(|(at, _)| span.contains(at))
            .count();
        assert!(
            (95..=105).contains(&lines),
            "{lines} lines in second {second}"
        );
    }
    assert_eq!(run.last(), [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(run.variable("vrduino_dropped_lines"), 0);
    assert_eq!(run.board.resets(), 0);
    assert_eq!(run.board.take_events(), []);
    assert_eq!(run.board.chip().sensor.complaints.list(), []);
}

/// An axis swapped or a sign flipped anywhere on the way fails one of these.
#[test]
fn turns_about_each_axis_both_ways_and_a_compound_turn_are_found_in_the_stream() {
    let script = [
        (X, 70.0),
        (X, -70.0),
        (Y, 80.0),
        (Y, -80.0),
        (Z, 60.0),
        (Z, -60.0),
        ([0.6, 0.0, 0.8], 100.0),
        ([0.0, 0.8, -0.6], 50.0),
    ];
    let (still, turn, pause) = (2.5, 0.6, 0.4);
    let motion = || {
        script
            .iter()
            .fold(Turns::new(still, pause), |turns, &(axis, degrees)| {
                turns.turn(axis, degrees, turn)
            })
    };
    let truth = motion();
    let mut run = Run::moved_by(motion());
    run.seconds(still);
    for (index, (axis, degrees)) in script.into_iter().enumerate() {
        run.seconds(turn + pause);
        let expected = truth
            .at(time::seconds(run.board.now()) - 0.01)
            .truth
            .unwrap();
        let error = degrees_between(run.last(), expected);
        // 0.01 °/s of bias left over, the sensor's resolution, and print.
        assert!(
            error < 0.2 + PRINTED,
            "turn {index}, {degrees}° about {axis:?}: {:?} instead of {expected:?}, {error}° off",
            run.last()
        );
    }
}

/// The tilt is taken from the accelerometer, on whichever side the board lies.
#[test]
fn a_board_that_lies_on_its_side_starts_with_that_tilt_and_no_yaw() {
    for (axis, degrees) in [(X, 90.0), (X, -50.0), (Z, 90.0), (Z, -120.0)] {
        let attitude = motion::rotation::about(axis, f64::to_radians(degrees));
        let mut run = Run::moved_by(Turns::new(1e6, 0.0).from_attitude(attitude));
        run.seconds(1.5);
        let error = degrees_between(run.last(), attitude);
        assert!(
            error < 0.1 + PRINTED,
            "{degrees}° about {axis:?}: {error}° off"
        );
    }
}

#[test]
fn gyro_bias_and_noise_are_calibrated_away_at_a_still_start() {
    let mut run = Run::with(Setup::new(motion::built_in()));
    run.seconds(2.9);
    assert!(run.text.contains("(still)"), "{}", run.text);
    let error = degrees_between(run.last(), [1.0, 0.0, 0.0, 0.0]);
    assert!(
        error < 0.5,
        "{error}° off after 1.7 s at rest with a bias of 1 °/s"
    );
}

/// The bias of the gyroscope is calibrated away. The accelerometer's stays: with biases of 60 and 80 mg, 2 % picked up
/// from the vertical axis, and 9 % less on that, the tilt is off by atan(√(0.08² + 0.10²) / 0.91) = 8.0° at most. A
/// quarter turn adds 3 % of itself in scale, and 2 % about each of the other axes: 3.7°. In a typical part the errors
/// are a third of that, one standard deviation.
#[test]
fn every_part_within_the_data_sheet_is_calibrated_and_follows() {
    for (part, share) in [(Part::typical(1), 0.6), (Part::worst(2), 1.0)] {
        let mut setup = Setup::new(Box::new(Turns::new(2.0, 0.3).turn(Y, 90.0, 1.0)));
        setup.part = part;
        let mut run = Run::with(setup);
        run.seconds(1.9);
        assert!(run.text.contains("(still)"), "{}", run.text);
        let tilt = degrees_between(run.last(), [1.0, 0.0, 0.0, 0.0]);
        assert!(tilt < share * 8.0 + PRINTED, "{tilt}° at rest");
        run.seconds(1.4);
        let expected = motion::rotation::about(Y, 90f64.to_radians());
        let off = degrees_between(run.last(), expected);
        assert!(
            off < share * 11.7 + PRINTED,
            "{off}° off after a quarter turn"
        );
        assert_eq!(run.board.chip().sensor.complaints.list(), []);
    }
}

#[test]
fn a_moving_start_streams_within_six_seconds_and_says_that_it_has_no_bias() {
    let shaken = (0..100).fold(Turns::new(0.0, 0.0), |turns, n| {
        turns.turn(Y, if n % 2 == 0 { 30.0 } else { -30.0 }, 0.25)
    });
    let mut run = Run::moved_by(shaken);
    run.wait_for("QC ", 6.5);
    assert!(run.text.contains("warning: not still"), "{}", run.text);
}

#[test]
fn the_sensors_own_clock_may_be_one_percent_off() {
    for error in [-0.01, 0.01] {
        let mut setup = Setup::new(Box::new(Turns::new(2.0, 0.3).turn(Y, 90.0, 1.0)));
        setup.part = setup.part.clock_error(error);
        let mut run = Run::with(setup);
        run.seconds(3.3);
        let expected = multiply(
            motion::rotation::about(Y, 90f64.to_radians()),
            [1.0, 0.0, 0.0, 0.0],
        );
        let off = degrees_between(run.last(), expected);
        assert!(off < 0.5, "clock {error}: {off}° off");
    }
}

#[test]
fn the_core_sleeps_most_of_the_time() {
    let mut run = Run::still();
    run.seconds(2.0);
    let before = run.board.measure().awake.greatest;
    run.board.run(SECOND);
    let load = (run.board.measure().awake.greatest - before) as f64 / SECOND as f64;
    assert!(
        load < 0.5,
        "the core is busy {:.1} % of the time",
        load * 100.0
    );
}
