//! What a host sees of the magnetometer.

use vrduino::command::Parser;
use vrduino::imu::RANGES;
use vrduino::sensor::RawSample;
use vrduino::sensor::magnetometer::{RawField, Resolution, SensitivityAdjustment};
use vrduino::tracker::{Health, Tracker};

const LEVEL: RawSample = RawSample {
    gyro: [0; 3],
    accel: [0, 2048, 0],
    temperature: 0,
    fresh: true,
};
const FIELD: RawField = RawField {
    counts: [100, 200, -300],
    resolution: Resolution::Bits16,
    overflow: false,
};
const TOO_STRONG: RawField = RawField {
    overflow: true,
    ..FIELD
};
const BEYOND_THE_RANGE: RawField = RawField {
    counts: [0, 0, i16::MIN],
    ..FIELD
};
const WARNING: &str =
    "warning: magnetic field of 4912 uT or more: move the board away from magnets\n";

/// A tracker that shows the INFO block, with this magnetometer.
fn tracker(adjustment: Option<SensitivityAdjustment>) -> Tracker {
    let mut tracker = Tracker::new(RANGES);
    tracker.set_magnetometer(adjustment);
    feed(&mut tracker, 1.0, None);
    let key = Parser::new().push(b'0').expect("a key with a meaning");
    tracker.command(key, &mut |_| {});
    tracker
}

/// Lines of so many seconds with a field in every tenth sample that begin with one of these words.
fn feed(tracker: &mut Tracker, seconds: f64, field: Option<RawField>) -> Vec<String> {
    let mut lines = Vec::new();
    for sample in 0..(1000.0 * seconds) as u32 {
        let field = field.filter(|_| sample % 10 == 3);
        tracker.update(&LEVEL, field, &Health::default(), &mut |line| {
            if line.starts_with("Field: ") || line.starts_with("warning") {
                lines.push(line.to_string());
            }
        });
    }
    lines
}

#[test]
fn the_field_is_shown_in_the_bodys_axes_adjusted_and_with_its_rate() {
    let asa = SensitivityAdjustment::from_fuse_rom([128, 192, 64]);
    let mut tracker = tracker(Some(asa));
    // y · 1.25, x, -z · 0.75, of 0.15 µT each.
    let expected = "Field: 37.500 15.000 33.750 uT (100 Hz)\n";
    assert_eq!(feed(&mut tracker, 2.0, Some(FIELD)), [expected, expected]);
    let stopped = feed(&mut tracker, 1.0, None);
    assert_eq!(stopped, ["Field: none\n"]);
}

#[test]
fn without_a_magnetometer_fields_are_passed_over() {
    let mut tracker = tracker(None);
    let shown = feed(&mut tracker, 1.0, Some(FIELD));
    assert_eq!(shown, ["Field: none\n"]);
    assert_eq!(feed(&mut tracker, 1.0, Some(TOO_STRONG)), ["Field: none\n"]);
}

#[test]
fn a_field_that_is_too_strong_is_warned_of_once_and_never_shown() {
    let mut tracker = tracker(Some(SensitivityAdjustment::NONE));
    let instead = WARNING.replace("warning", "Field");
    let lines = feed(&mut tracker, 2.0, Some(TOO_STRONG));
    assert_eq!(lines, [WARNING, &instead, &instead]);
    // Half a second without is not worth another warning; a whole one is.
    feed(&mut tracker, 0.5, Some(FIELD));
    assert_eq!(
        feed(&mut tracker, 0.5, Some(TOO_STRONG)),
        [instead.as_str()]
    );
    feed(&mut tracker, 1.0, Some(FIELD));
    assert_eq!(feed(&mut tracker, 0.5, Some(TOO_STRONG)), [WARNING]);
}

#[test]
fn counts_that_no_measurement_has_are_warned_of_too() {
    let mut tracker = tracker(Some(SensitivityAdjustment::NONE));
    let lines = feed(&mut tracker, 1.0, Some(BEYOND_THE_RANGE));
    assert!(lines[0].starts_with("warning: magnetometer counts beyond"));
    assert!(lines[1].starts_with("Field: magnetometer counts beyond"));
    assert_eq!(lines.len(), 2);
}

#[test]
fn what_adjusts_the_streamed_counts_can_be_asked_for() {
    for (asa, answer) in [
        (Some([128, 192, 64]), "OK compass adjustment 128 192 64\n"),
        (
            None,
            "OK compass adjustment none, there is no magnetometer\n",
        ),
    ] {
        let mut tracker = Tracker::new(RANGES);
        tracker.set_magnetometer(asa.map(SensitivityAdjustment::from_fuse_rom));
        let mut parser = Parser::new();
        let mut commands = b":compass adjustment\n"
            .iter()
            .filter_map(|&b| parser.push(b));
        let command = commands.next().expect("a line with a meaning");
        let mut lines = Vec::new();
        tracker.command(command, &mut |line| lines.push(line.to_string()));
        assert_eq!(lines, [answer]);
    }
}
