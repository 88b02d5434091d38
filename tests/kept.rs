//! A calibration that a host hands to the board, line by line.

#[path = "tracker/bench.rs"]
mod bench;

use bench::{Bench, LEVEL, handled};
use nalgebra::{Matrix3, Vector3};
use vrduino::calibration::ellipsoid::Magnetometer;
use vrduino::calibration::record::{Gyro, LENGTH, Record};
use vrduino::calibration::six_positions::Accelerometer;
use vrduino::sensor::RawSample;
use vrduino::sensor::magnetometer::{RawField, Resolution, SensitivityAdjustment};
use vrduino::tracker::Health;
use vrduino::units::{Angle, AngularRate, MagneticField, SpecificForce};

fn record() -> Record {
    Record {
        gyro: Some(Gyro {
            bias: AngularRate::from_dps(Vector3::new(0.0, 0.488, 0.0)),
            temperature_celsius: 25.0,
        }),
        accelerometer: Some(Accelerometer {
            bias: SpecificForce::from_g(Vector3::new(0.1, 0.0, 0.0)),
            matrix: Matrix3::from_diagonal(&Vector3::new(1.0, 0.9, 1.0)),
            residual: 0.012,
            placing: Angle::from_degrees(1.0),
            temperature_celsius: 25.0,
        }),
        magnetometer: Some(Magnetometer {
            hard_iron: MagneticField::from_microtesla(Vector3::new(30.0, 0.0, 0.0)),
            soft_iron: Matrix3::identity(),
            strength_microtesla: 44.7,
            error_percent: 1.9,
            coverage: 0.9,
            largest_hole: Angle::from_degrees(30.0),
            temperature_celsius: 25.0,
        }),
    }
}

/// The lines a host sends.
fn lines(bytes: &[u8]) -> Vec<String> {
    let pieces = bytes.chunks(24).enumerate();
    let line = |(number, piece): (usize, &[u8])| {
        let digits: String = piece.iter().map(|byte| format!("{byte:02x}")).collect();
        format!(":keep {} {digits}", 24 * number)
    };
    pieces.map(line).chain([":keep done".into()]).collect()
}

fn hand_over(bench: &mut Bench, record: &Record) -> String {
    let mut last = String::new();
    for line in lines(&record.to_bytes()) {
        last = bench.ask(&line).to_owned();
    }
    last
}

const ALL: &str = "OK calibration: field 44.7 uT within 1.9 %, force within 0.012 m/s2\n";

#[test]
fn a_record_in_pieces_is_used_and_handed_on_once() {
    let mut bench = Bench::started();
    assert_eq!(bench.ask(":calibration"), "OK calibration: none\n");
    let pieces = lines(&record().to_bytes());
    assert_eq!(bench.ask(&pieces[0]), "OK keep 24 bytes at 0\n");
    assert_eq!(bench.ask(":calibration"), "OK calibration: none\n");
    assert_eq!(hand_over(&mut bench, &record()), ALL);
    assert_eq!(bench.tracker.take_calibration_to_keep(), Some(record()));
    assert_eq!(bench.tracker.take_calibration_to_keep(), None);
    // The force: (0.1 g, 1.111 g, 0) is 1 g up.
    bench.ask(":estimator notes");
    bench.type_in(b"4");
    bench.lines.clear();
    bench.feed(10, |_| RawSample {
        accel: [205, 2276, 0],
        ..LEVEL
    });
    assert_eq!(bench.texts(), ["ACC: 0.001 9.812 0.000\n"]);
}

#[test]
fn what_is_no_record_is_refused_and_nothing_changes() {
    let mut bench = Bench::started();
    assert_eq!(
        bench.ask(":keep done"),
        "ERR done: no calibration kept: calibrate\n"
    );
    assert_eq!(hand_over(&mut bench, &record()), ALL);
    bench.tracker.take_calibration_to_keep();
    let mut damaged = record().to_bytes();
    damaged[90] ^= 1;
    for line in lines(&damaged) {
        bench.ask(&line);
    }
    let answer = bench.lines.last().expect("an answer").1.clone();
    assert!(answer.starts_with("ERR done: checksum"), "{answer}");
    assert_eq!(bench.ask(":calibration"), ALL);
    assert_eq!(bench.tracker.take_calibration_to_keep(), None);
    for (line, answer) in [
        (
            ":keep",
            "ERR keep: an offset and bytes, or done, is wanted\n",
        ),
        (":keep x 00", "ERR x: an offset from 0 or done is wanted\n"),
        (
            ":keep 0",
            "ERR 0: an offset and bytes, or done, is wanted\n",
        ),
        (
            ":keep 0 0",
            "ERR 0: 1 to 24 bytes in hexadecimal is wanted\n",
        ),
        (
            ":keep 0 0g",
            "ERR 0g: 1 to 24 bytes in hexadecimal is wanted\n",
        ),
        (":keep 139 0000", "ERR 139: a record has 140 bytes\n"),
        (":keep 255 00", "ERR 255: a record has 140 bytes\n"),
        (
            ":keep 256 00",
            "ERR 256: an offset from 0 or done is wanted\n",
        ),
    ] {
        assert_eq!(bench.ask(line), answer, "{line}");
    }
    assert_eq!(LENGTH, 140);
}

#[test]
fn a_sound_checksum_over_nonsense_is_refused_too() {
    let mut bench = Bench::started();
    let good = record();
    let accelerometer = good.accelerometer.expect("there");
    let magnetometer = good.magnetometer.expect("there");
    for bad in [
        Record {
            accelerometer: Some(Accelerometer {
                matrix: Matrix3::identity() * 1000.0,
                ..accelerometer
            }),
            ..good
        },
        Record {
            gyro: Some(Gyro {
                bias: AngularRate::from_rad_per_s(Vector3::new(5000.0, 0.0, 0.0)),
                temperature_celsius: 25.0,
            }),
            ..good
        },
        Record {
            magnetometer: Some(Magnetometer {
                soft_iron: Matrix3::zeros(),
                ..magnetometer
            }),
            ..good
        },
        Record {
            magnetometer: Some(Magnetometer {
                strength_microtesla: 0.0,
                ..magnetometer
            }),
            ..good
        },
    ] {
        let answer = hand_over(&mut bench, &bad);
        assert!(answer.contains("cannot be meant"), "{answer}");
        assert_eq!(bench.ask(":calibration"), "OK calibration: none\n");
    }
}

#[test]
fn a_part_that_is_not_in_a_record_stays_as_it_was() {
    let mut bench = Bench::started();
    hand_over(&mut bench, &record());
    let only_gyro = Record {
        accelerometer: None,
        magnetometer: None,
        ..record()
    };
    assert_eq!(hand_over(&mut bench, &only_gyro), ALL);
    assert_eq!(bench.tracker.take_calibration_to_keep(), Some(record()));
}

#[test]
fn what_is_forgotten_is_handed_on_as_empty() {
    let mut bench = Bench::started();
    hand_over(&mut bench, &record());
    assert_eq!(bench.ask(":forget"), "OK calibration: none\n");
    assert_eq!(
        bench.tracker.take_calibration_to_keep(),
        Some(Record::default())
    );
}

#[test]
fn a_kept_bias_serves_until_one_is_measured() {
    let mut bench = Bench::new();
    bench.tracker.set_calibration(&record());
    bench.feed(5000, handled);
    let said = bench.ask(":bias");
    assert!(
        said.starts_with("OK bias") && said.ends_with("never still, a guess\n"),
        "{said}"
    );
    let rate: f64 = said.split(' ').nth(3).unwrap().parse().unwrap();
    assert!((rate - 0.488).abs() < 0.1, "{said}");
    // Once measured, a record from elsewhere does not move it.
    let mut bench = Bench::started();
    let other = Record {
        gyro: Some(Gyro {
            bias: AngularRate::from_dps(Vector3::new(3.0, 3.0, 3.0)),
            temperature_celsius: 25.0,
        }),
        ..record()
    };
    hand_over(&mut bench, &other);
    assert!(bench.ask(":bias").starts_with("OK bias 0.000 0.488 0.000"));
}

/// Heading in degrees after ten seconds of a level board in a field that a hard iron of 30 µT on x
/// has turned.
fn heading(bench: &mut Bench) -> f64 {
    let asa = SensitivityAdjustment::from_fuse_rom([128; 3]);
    bench.tracker.set_magnetometer(Some(asa));
    // Body (30, −40, −20) µT at 0.15 µT a count; the magnetometer's own axes are y, x, −z.
    let field = RawField {
        counts: [-267, 200, 133],
        resolution: Resolution::Bits16,
        overflow: false,
    };
    for sample in 0..10_000 {
        let due = (sample % 10 == 0).then_some(field);
        bench
            .tracker
            .update(&LEVEL, due, &Health::default(), &mut |_| {});
    }
    let q = bench.tracker.orientation();
    f64::from(2.0 * q.j.atan2(q.w)).to_degrees()
}

#[test]
fn the_compass_is_followed_once_its_iron_is_known_or_when_asked_to() {
    let mut bench = Bench::started();
    assert!(heading(&mut bench).abs() < 0.1);
    let unused = "OK compass auto: not used, the field is not calibrated\n";
    assert_eq!(bench.ask(":compass"), unused);

    bench.ask(":compass on");
    let wrong = heading(&mut bench);
    assert!(
        (wrong - 56.0).abs() < 2.0,
        "uncalibrated it points to {wrong}°"
    );

    let mut bench = Bench::started();
    bench.tracker.set_calibration(&Record {
        accelerometer: None,
        ..record()
    });
    assert!(heading(&mut bench).abs() < 1.0, "{}°", heading(&mut bench));
    assert_eq!(
        bench.ask(":compass"),
        "OK compass auto: heading by compass\n"
    );
    bench.ask(":compass off");
    assert_eq!(bench.ask(":compass"), "OK compass off\n");
}
