//! The very image that is flashed, booted on the emulated board.
//!
//! The emulator shares no code with the firmware, so what these tests see on the emulated serial port
//! has gone through two independent readings of the manuals.

use std::path::PathBuf;
use std::sync::OnceLock;

use vrduino::sensor::RawSample;
use vrduino::tracker::{Health, Tracker};
use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::firmware::{self, BuildOptions};
use vrduino_emulator::host::{Outcome, Request};
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::rotation::{angle_between, multiply, rotate};
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::motion::{self, Motion};
use vrduino_emulator::time::{self, MILLISECOND, SECOND};

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// A printed component is off by half a digit in the third decimal at most; on a quaternion that is
/// 0.11° in the worst case.
const PRINTED: f64 = 0.11;

fn image() -> Image {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    let path = PATH.get_or_init(|| {
        firmware::build(BuildOptions { quiet: true }).expect("the firmware builds")
    });
    Image::open(path).expect("the emulator accepts the firmware")
}

/// A board that runs, and what its host has read.
struct Run {
    board: Board,
    text: String,
    /// How much of the text has been taken apart.
    read: usize,
    /// Each orientation with the time at which the host had it.
    orientations: Vec<(f64, [f64; 4])>,
}

impl Run {
    fn with(setup: Setup) -> Run {
        Run {
            board: Board::new(image(), setup),
            text: String::new(),
            read: 0,
            orientations: Vec::new(),
        }
    }

    fn moved_by(motion: impl Motion + 'static) -> Run {
        Run::with(Setup::new(Box::new(motion)))
    }

    fn still() -> Run {
        Run::moved_by(Turns::new(1e6, 0.0))
    }

    fn seconds(&mut self, seconds: f64) {
        let until = self.board.now() + time::ticks(seconds);
        while self.board.now() < until {
            self.board.run(MILLISECOND);
            let received = self.board.chip_quietly().host.take_received();
            let now = time::seconds(self.board.now());
            self.text
                .push_str(std::str::from_utf8(&received).expect("the stream is text"));
            // A line counts once its end is there.
            while let Some(end) = self.text[self.read..].find('\n') {
                let line = &self.text[self.read..self.read + end];
                self.orientations.extend(quaternion(line).map(|q| (now, q)));
                self.read += end + 1;
            }
        }
    }

    /// Forgets the text so far, to wait for something new.
    fn forget(&mut self) {
        self.text.drain(..self.read);
        self.read = 0;
    }

    fn wait_for(&mut self, text: &str, seconds: f64) {
        let until = self.board.now() + time::ticks(seconds);
        while !self.text.contains(text) {
            assert!(
                self.board.now() < until,
                "no {text:?} within {seconds} s, but:\n{}\n{:?}",
                self.text,
                self.board.take_events()
            );
            self.seconds(0.01);
        }
    }

    fn last(&self) -> [f64; 4] {
        self.orientations.last().expect("there are orientations").1
    }

    fn variable(&self, name: &str) -> u32 {
        self.board
            .variable(name)
            .expect("the image has this symbol")
    }
}

/// The components of a QC line, if it is a whole one.
fn quaternion(line: &str) -> Option<[f64; 4]> {
    let numbers: Vec<f64> = line
        .strip_prefix("QC ")?
        .split(' ')
        .map(|n| n.parse().unwrap())
        .collect();
    let q: [f64; 4] = numbers.try_into().expect("four components");
    let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    assert!((norm - 1.0).abs() <= 0.002, "|q| = {norm} in {line:?}");
    Some(q)
}

fn degrees_between(a: [f64; 4], b: [f64; 4]) -> f64 {
    angle_between(a, b).to_degrees()
}

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
}

#[test]
fn a_strict_host_enumerates_the_board_as_a_teensy_and_finds_nothing_to_object_to() {
    let mut run = Run::still();
    run.seconds(2.0);
    let chip = run.board.chip();
    let device = chip.host.identity().expect("the device is configured");
    assert_eq!((device.vendor, device.product), (0x16C0, 0x0483));
    assert_eq!(device.manufacturer, "Teensyduino");
    assert_eq!(chip.host.complaints, [""; 0]);
    assert_eq!(chip.usb.complaints, [""; 0]);
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
    let mut truth = motion();
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
fn the_stream_agrees_with_the_library_on_the_same_samples_generated() {
    let mut run = Run::with(Setup::new(motion::built_in()));
    run.board.chip().sensor.recording = Some(Vec::new());
    run.seconds(9.0);
    agrees_with_library(&mut run);
}

/// Runs the library on the bursts the firmware has read and compares line by line.
///
/// Both run the same single-precision code, one compiled for the host and one for a processor without
/// floating point; the bound is one unit of the last printed digit.
fn agrees_with_library(run: &mut Run) {
    let bursts = run
        .board
        .chip()
        .sensor
        .recording
        .take()
        .expect("recording is on");
    let mut tracker = Tracker::new(vrduino::imu::RANGES);
    let mut expected = Vec::new();
    for burst in &bursts {
        tracker.update(
            &RawSample::from_burst(&burst.bytes),
            &Health::default(),
            &mut |line| expected.extend(quaternion(line.trim_end())),
        );
    }
    assert_eq!(run.variable("vrduino_dropped_lines"), 0);
    let compared = run.orientations.len();
    assert!(compared > 500, "only {compared} lines to compare");
    assert!(
        expected.len().abs_diff(compared) <= 2,
        "{} against {compared}",
        expected.len()
    );
    for (index, ((at, streamed), expected)) in run.orientations.iter().zip(&expected).enumerate() {
        for (a, b) in streamed.iter().zip(expected) {
            assert!(
                (a - b).abs() <= 0.001 + 1e-9,
                "line {index} at {at} s: {streamed:?} instead of {expected:?}"
            );
        }
    }
}

/// Samples from the start of movement on that are compared.
const MOVEMENT: f64 = 22.0;

fn follows_recording(name: &str) {
    let folder = std::env::var_os("VRDUINO_MOTIONS").expect("VRDUINO_MOTIONS names a folder");
    let path = PathBuf::from(folder).join(name);
    let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    // The recording's own marks (layout: 64 bytes of header, 28 a sample, the last two are flags).
    let moving: Vec<bool> = bytes[64..]
        .chunks_exact(28)
        .map(|record| record[26] & 1 != 0)
        .collect();
    let rate = 2000.0 / 7.0;
    let begin = moving
        .iter()
        .position(|&moving| moving)
        .expect("there is movement") as f64
        / rate;
    let start = begin - 3.0;
    let in_motion = moving
        .iter()
        .skip((begin * rate) as usize)
        .take((MOVEMENT * rate) as usize)
        .filter(|&&moving| moving)
        .count() as f64
        / rate;
    assert!(
        in_motion >= 20.0,
        "{name} moves for {in_motion} s of {MOVEMENT} only"
    );

    let open = || motion::skip(motion::open(&path).unwrap(), start).unwrap();
    let mut truth = open();
    let mut run = Run::with(Setup::new(open()));
    run.board.chip().sensor.recording = Some(Vec::new());
    run.seconds(3.0 + MOVEMENT);

    // Inclination against the optical reference: where the two think up is, seen from the body.
    let errors: Vec<f64> = run
        .orientations
        .iter()
        .filter_map(|&(at, streamed)| {
            let reference = truth.at(at - 0.002).truth?;
            let (a, b) = (up_in_body(streamed), up_in_body(reference));
            let cosine: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
            Some(cosine.clamp(-1.0, 1.0).acos().to_degrees())
        })
        .collect();
    assert!(
        errors.len() > 1800,
        "{name}: only {} references",
        errors.len()
    );
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    eprintln!(
        "{name}: inclination {rms:.2}° rms over {:.1} s",
        errors.len() as f64 / 100.0
    );
    // The course filter at its best time constant has 4.2° on average over whole recordings.
    assert!(rms < 8.0, "{name}: inclination {rms}° rms");
    agrees_with_library(&mut run);
}

fn up_in_body(body_to_world: [f64; 4]) -> [f64; 3] {
    let [w, x, y, z] = body_to_world;
    rotate([w, -x, -y, -z], Y)
}

#[test]
#[ignore = "needs VRDUINO_MOTIONS"]
fn follows_a_recorded_slow_rotation() {
    follows_recording("02_undisturbed_slow_rotation_B.imub");
}

#[test]
#[ignore = "needs VRDUINO_MOTIONS"]
fn follows_a_recorded_fast_rotation() {
    follows_recording("06_undisturbed_fast_rotation_A.imub");
}

#[test]
#[ignore = "needs VRDUINO_MOTIONS"]
fn follows_a_recorded_fast_translation() {
    follows_recording("15_undisturbed_fast_translation_A.imub");
}

#[test]
fn a_host_that_stops_reading_costs_lines_but_no_samples() {
    let motion = || Turns::new(2.5, 0.2).turn(Y, 90.0, 1.0);
    let mut run = Run::moved_by(motion());
    run.seconds(2.0);
    run.board.chip().host.set_reading(false);
    run.seconds(2.0);
    run.board.chip().host.set_reading(true);
    run.seconds(0.3);
    let dropped = run.variable("vrduino_dropped_lines");
    assert!(
        (150..=200).contains(&dropped),
        "{dropped} lines dropped in 2 s"
    );
    assert!(
        run.text
            .lines()
            .all(|line| line.is_empty() || line.len() > 6),
        "a torn line"
    );
    let expected = motion().at(10.0).truth.unwrap();
    let error = degrees_between(run.last(), expected);
    assert!(
        error < 0.2 + PRINTED,
        "{error}° off: samples were lost with the lines"
    );
}

#[test]
fn the_board_survives_a_bus_reset_a_replug_and_back_to_back_requests() {
    let mut run = Run::still();
    run.seconds(1.5);
    run.board.chip().host.reset_bus();
    run.seconds(0.4);
    assert!(
        run.board.chip().host.is_open(),
        "not enumerated again after a bus reset"
    );
    run.board.chip().host.set_plugged(false);
    run.seconds(0.3);
    run.board.chip().host.set_plugged(true);
    run.seconds(0.5);
    {
        let mut chip = run.board.chip();
        assert!(chip.host.is_open(), "not enumerated again after a replug");
        for _ in 0..5 {
            // One that must be refused between two that must be answered.
            chip.host.request(Request::read(0x80, 6, 0x0100, 0, 18));
            chip.host.request(Request::read(0x80, 6, 0x0600, 0, 10));
            chip.host.request(Request::write(
                0x21,
                0x20,
                0,
                0,
                &[0x80, 0x25, 0, 0, 0, 0, 8],
            ));
            chip.host.request(Request::read(0xA1, 0x21, 0, 0, 7));
        }
    }
    run.seconds(0.2);
    let outcomes = run.board.chip().host.take_outcomes();
    assert_eq!(outcomes.len(), 20);
    for (request, outcome) in &outcomes {
        match (request.setup[1], request.setup[3], outcome) {
            (6, 1, Outcome::Done(descriptor)) => assert_eq!(descriptor.len(), 18),
            (6, 6, Outcome::Stalled) => {}
            (0x20, _, Outcome::Done(_)) => {}
            (0x21, _, Outcome::Done(coding)) => assert_eq!(coding[..4], [0x80, 0x25, 0, 0]),
            _ => panic!("{request:02x?} ended with {outcome:?}"),
        }
    }
    let before = run.orientations.len();
    run.seconds(0.5);
    assert!(
        run.orientations.len() > before + 40,
        "the stream has not gone on"
    );
    assert_eq!(run.board.chip().host.complaints, [""; 0]);
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn keys_choose_what_is_streamed() {
    let mut run = Run::still();
    run.seconds(1.5);
    for (key, tag) in [
        ("1", "FLAT "),
        ("2", "EA "),
        ("3", "GYR: "),
        ("4", "ACC: "),
        ("0", "nReads/sec: "),
    ] {
        run.forget();
        run.board.chip().host.send(key.as_bytes());
        run.wait_for(tag, 1.5);
    }
    run.forget();
    run.board.chip().host.send(b"b5");
    run.wait_for("Measuring bias", 0.5);
    run.wait_for("(still)", 2.0);
    run.wait_for("QC ", 0.5);
}

#[test]
fn reset_brings_the_heading_back_to_zero_and_keeps_the_tilt() {
    let motion = Turns::new(2.0, 5.0).turn(Y, 60.0, 0.5);
    let mut run = Run::moved_by(motion);
    run.seconds(3.0);
    assert!(degrees_between(run.last(), [1.0, 0.0, 0.0, 0.0]) > 55.0);
    run.board.chip().host.send(b"r");
    run.seconds(0.1);
    assert!(degrees_between(run.last(), [1.0, 0.0, 0.0, 0.0]) < 0.5);
}

#[test]
fn a_missing_sensor_is_reported_and_found_once_it_is_there() {
    let mut run = Run::still();
    run.board.chip().sensor.faults.absent = true;
    run.wait_for("error: no IMU answers at I2C address 0x68", 3.0);
    assert!(run.orientations.is_empty());
    run.board.chip().sensor.faults.absent = false;
    run.wait_for("QC ", 4.0);
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn an_unknown_part_is_named() {
    let mut setup = Setup::new(Box::new(Turns::new(1e6, 0.0)));
    setup.who_am_i = 0x68;
    let mut run = Run::with(setup);
    run.wait_for("error: unknown part 0x68", 2.0);
    run.seconds(2.0);
    assert!(run.orientations.is_empty());
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn parts_of_the_same_family_are_accepted() {
    for who_am_i in [0x70, 0x73] {
        let mut setup = Setup::new(Box::new(Turns::new(1e6, 0.0)));
        setup.who_am_i = who_am_i;
        Run::with(setup).wait_for("QC ", 2.0);
    }
}

#[test]
fn a_sensor_that_stops_answering_is_reported_and_taken_up_again() {
    let mut run = Run::still();
    run.seconds(1.5);
    run.board.chip().sensor.faults.absent = true;
    run.wait_for("error: the IMU stopped answering", 1.0);
    run.board.chip().sensor.faults.absent = false;
    run.forget();
    run.wait_for("QC ", 2.5);
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn a_sensor_without_new_samples_is_reported() {
    let mut run = Run::still();
    run.seconds(1.5);
    run.board.chip().sensor.faults.frozen = true;
    run.wait_for("error: the IMU takes no new samples", 1.0);
    run.board.chip().sensor.faults.frozen = false;
    run.forget();
    run.wait_for("QC ", 2.5);
}

#[test]
fn a_sensor_that_lost_its_settings_is_set_up_again() {
    let mut run = Run::still();
    run.seconds(1.5);
    let now = run.board.now();
    run.board.chip().sensor.brown_out(now);
    run.wait_for("error: the IMU", 1.0);
    run.forget();
    run.wait_for("QC ", 2.5);
    assert!(degrees_between(run.last(), [1.0, 0.0, 0.0, 0.0]) < 1.0);
}

#[test]
fn a_bus_held_by_the_sensor_at_power_on_is_clocked_free() {
    let mut run = Run::still();
    run.board.chip().pins.sda_held_for = 7;
    run.wait_for("QC ", 3.0);
    assert!(!run.text.contains("error"), "{}", run.text);
}

#[test]
fn a_clock_line_held_low_is_reported_and_never_hangs_the_board() {
    let mut run = Run::still();
    run.seconds(1.5);
    run.board.chip().pins.scl_held = true;
    run.wait_for("error: ", 1.0);
    run.seconds(1.0);
    run.board.chip().pins.scl_held = false;
    run.forget();
    run.wait_for("QC ", 3.0);
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn a_hang_becomes_a_watchdog_reset_and_the_next_life_says_where() {
    let mut run = Run::still();
    run.seconds(1.5);
    // An endless loop: the branch-to-self behind a hard fault will do.
    let address = run
        .board
        .image()
        .address_of("rust_begin_unwind")
        .expect("the panic handler is there");
    run.board.jump(address);
    run.wait_for("warning: reset by watchdog", 2.0);
    assert_eq!(run.board.resets(), 1);
    run.forget();
    run.wait_for("QC ", 3.0);
}

#[test]
fn the_sensors_own_clock_may_be_one_percent_off() {
    for error in [-0.01, 0.01] {
        let mut setup = Setup::new(Box::new(Turns::new(2.0, 0.3).turn(Y, 90.0, 1.0)));
        setup.sensor_clock_error = error;
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
    let before = run.board.awake_for();
    run.board.run(SECOND);
    let load = (run.board.awake_for() - before) as f64 / SECOND as f64;
    assert!(
        load < 0.5,
        "the core is busy {:.1} % of the time",
        load * 100.0
    );
}
