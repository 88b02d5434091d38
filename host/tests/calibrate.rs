//! Promise: what the calibration finds is what is wrong with the part, the board keeps it, and poor data is refused.

mod program;

use program::{Ended, place, vrduino};
use vrduino_emulator::mpu9250::Part;

const G: f64 = 9.80665;

/// The three numbers behind this word in the line that begins with that name.
fn three(ended: &Ended, name: &str, word: &str) -> [f64; 3] {
    let line = ended.out.lines().find(|line| line.starts_with(name));
    let line = line.unwrap_or_else(|| panic!("{name}: {ended:?}"));
    let (_, rest) = line.split_once(word).expect("the word");
    let numbers: Vec<f64> = rest
        .split([' ', ','])
        .filter(|word| !word.is_empty())
        .map_while(|word| word.parse().ok())
        .collect();
    numbers[..3].try_into().expect("three numbers")
}

#[track_caller]
fn near(found: [f64; 3], truth: [f64; 3], within: f64) {
    for (found, truth) in found.iter().zip(truth) {
        assert!((found - truth).abs() < within, "{found} for {truth}");
    }
}

#[test]
fn the_faults_of_a_typical_part_are_found_and_kept() {
    let picture = place("typical.svg");
    let ended = vrduino(&[
        "calibrate",
        "--emulate",
        "--unpaced",
        "--part",
        "typical",
        "--seed",
        "5",
        "--yes",
        "--picture",
        picture.to_str().expect("plain letters"),
    ]);
    ended
        .expect(0)
        .said("all six faces")
        .said("the board keeps it: field");
    let part = Part::typical(5);
    near(three(&ended, "gyro", "bias"), part.gyro.bias, 0.1);
    near(
        three(&ended, "accelerometer", "bias"),
        part.accel.bias.map(|bias| bias * G),
        0.02,
    );
    near(
        three(&ended, "accelerometer", "factors"),
        part.accel.scale.map(|scale| 1.0 / (1.0 + scale)),
        0.002,
    );
    // Exchanged, and negated: the magnetometer has axes of its own.
    let [x, y, z] = part.magnetic.offset;
    near(three(&ended, "magnetometer", "hard iron"), [y, x, -z], 1.0);
    let drawn = std::fs::read_to_string(&picture).expect("the picture");
    assert!(drawn.matches("<circle").count() > 200, "{}", drawn.len());
    std::fs::remove_file(&picture).expect("removed");
}

#[test]
fn a_board_that_only_lies_there_is_refused_with_what_is_missing() {
    let lines = place("still.keep");
    let picture = place("still.svg");
    vrduino(&[
        "calibrate",
        "--emulate",
        "--unpaced",
        "--motion",
        "still",
        "--seconds",
        "3",
        "--dry-run",
        lines.to_str().expect("plain letters"),
        "--picture",
        picture.to_str().expect("plain letters"),
    ])
    .expect(4)
    .said("accelerometer  refused: not still long enough with x up, x down, y down, z up, z down")
    .said("magnetometer   refused: ")
    .said("nothing sent");
    // The gyro's bias alone is worth keeping.
    let lines_said = std::fs::read_to_string(&lines).expect("the lines");
    assert_eq!(lines_said.lines().count(), 7, "{lines_said}");
    assert!(lines_said.starts_with(":keep 0 5643"), "{lines_said}");
    assert!(lines_said.ends_with(":keep done\n"), "{lines_said}");
    for file in [lines, picture] {
        std::fs::remove_file(file).expect("removed");
    }
}

#[test]
fn what_makes_no_sense_is_refused_at_once() {
    vrduino(&["calibrate", "--emulate", "--seconds", "0"]).expect(2);
    vrduino(&["calibrate", "--replay", "x.csv"])
        .expect(4)
        .said("cannot be laid on its faces");
    vrduino(&["calibrate", "--port", "tcp:127.0.0.1:1"])
        .expect(3)
        .said("nothing answers");
}
