//! The stream beside the library and beside recorded motions with an optical reference.

use std::path::PathBuf;

use vrduino::command::Parser;
use vrduino::sensor::RawSample;
use vrduino::sensor::magnetometer::{RawField, SensitivityAdjustment};
use vrduino::tracker::{Health, Tracker};
use vrduino_emulator::board::Setup;
use vrduino_emulator::motion;
use vrduino_emulator::motion::rotation::rotate;

use crate::run::{Run, SIX_DECIMALS, Y, degrees_between, quaternion};

#[test]
fn the_stream_agrees_with_the_library_on_the_same_samples_generated() {
    let mut run = Run::with(Setup::new(motion::built_in()));
    run.board.chip().sensor.recording = Some(Vec::new());
    run.with_six_decimals(8.0);
    agrees_with_library(&mut run);
}

/// Most that the board and the library may differ, in degrees. Both run the same integers, but the board
/// by the sensor's period as it has measured it, and the library here by the nominal one.
const DIFFERENCE: f64 = 0.1;

/// Runs the library on the bursts the firmware has read and compares line by line, at six decimals.
fn agrees_with_library(run: &mut Run) {
    let bursts = run
        .board
        .chip()
        .sensor
        .recording
        .take()
        .expect("recording is on");
    let mut tracker = Tracker::new(vrduino::imu::RANGES);
    let mut parser = Parser::new();
    let typed = SIX_DECIMALS.iter().filter_map(|&byte| parser.push(byte));
    typed.for_each(|command| tracker.command(command, &mut |_| {}));
    // The part of these tests is a perfect one.
    tracker.set_magnetometer(Some(SensitivityAdjustment::NONE));
    let (mut expected, mut field) = (Vec::new(), None);
    for burst in &bursts {
        tracker.update(
            &RawSample::from_burst(&burst.bytes),
            field,
            &Health::default(),
            &mut |line| expected.extend(quaternion(line.trim_end())),
        );
        // What is read behind a burst comes with the next.
        let counts = burst.field.as_ref().and_then(|bytes| bytes.last_chunk());
        field = counts.map(RawField::from_burst);
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
        let apart = degrees_between(*streamed, *expected);
        assert!(
            apart < DIFFERENCE,
            "line {index} at {at} s: {streamed:?} instead of {expected:?}, {apart}°"
        );
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
    let truth = open();
    let mut run = Run::with(Setup::new(open()));
    run.board.chip().sensor.recording = Some(Vec::new());
    run.with_six_decimals(2.0 + MOVEMENT);

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
    // Over whole recordings the library has 0.7° on average and 1.6° at worst.
    assert!(rms < 2.0, "{name}: inclination {rms}° rms");
    agrees_with_library(&mut run);
}

fn up_in_body(body_to_world: [f64; 4]) -> [f64; 3] {
    let [w, x, y, z] = body_to_world;
    rotate([w, -x, -y, -z], Y)
}

#[test]
// Ignored without the recordings: they are a benchmark's data, which this repository does not carry.
#[ignore = "needs VRDUINO_MOTIONS, a folder of recorded motions, which are not kept here"]
fn follows_a_recorded_slow_rotation() {
    follows_recording("02_undisturbed_slow_rotation_B.imub");
}

#[test]
// Ignored without the recordings: they are a benchmark's data, which this repository does not carry.
#[ignore = "needs VRDUINO_MOTIONS, a folder of recorded motions, which are not kept here"]
fn follows_a_recorded_fast_rotation() {
    follows_recording("06_undisturbed_fast_rotation_A.imub");
}

#[test]
// Ignored without the recordings: they are a benchmark's data, which this repository does not carry.
#[ignore = "needs VRDUINO_MOTIONS, a folder of recorded motions, which are not kept here"]
fn follows_a_recorded_fast_translation() {
    follows_recording("15_undisturbed_fast_translation_A.imub");
}
