//! `vrduino record` of the emulated board.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use vrduino::orientation::euler::EulerAngles;
use vrduino::sensor::{AccelRange, GyroRange, Ranges};
use vrduino_host::hub::{Hold, Hub, Update};
use vrduino_host::recording::{Assembly, Entry, Head, Reader, Voice};
use vrduino_host::source::{Choice, Emulation};

use crate::fixture::{Scratch, assert_same, entries, samples, turns, write};
use crate::program::vrduino;

#[test]
fn none_is_missing_and_the_board_is_introduced() {
    let all = entries(turns());
    let samples = samples(&all);
    assert!((4000..=4002).contains(&samples.len()), "{}", samples.len());
    for pair in samples.windows(2) {
        let [before, now] = pair else { continue };
        let next = before.sequence.map(|number| number.wrapping_add(1));
        assert_eq!(now.sequence, next);
        assert!((now.time - before.time - 1e-3).abs() < 50e-6, "{now:?}");
        assert!(now.arrival > before.arrival - 1e-6);
        assert!(!now.is_first);
    }
    let reader = Reader::open(Path::new(turns())).expect("a recording");
    let head = reader.head();
    assert_eq!(head.board.as_deref(), Some("vrduino 0.1.0"));
    assert_eq!(head.source, "emulated board");
    assert_eq!(head.stream.as_deref(), Some("counts every 1"));
    assert_eq!(head.settings["tilt-time"], 3.0);
    assert_eq!(head.settings.len(), 7);
    assert!(
        head.started.len() > 20 && head.started.contains('T'),
        "{head:?}"
    );
    let said: BTreeSet<_> = all
        .iter()
        .filter_map(|entry| match entry {
            Entry::Remark(remark) if remark.voice == Voice::Board => Some(remark.text.as_str()),
            _ => None,
        })
        .collect();
    assert!(said.contains("Measuring bias"), "{said:?}");
    assert!(said.contains("OK stream counts every 1"), "{said:?}");
}

/// A quarter turn to the left within the second after the third; then it rests.
#[test]
fn it_holds_the_motion_and_what_the_sensor_made_of_it() {
    let ranges = Ranges {
        gyro: GyroRange::Dps2000,
        accel: AccelRange::G16,
    };
    let (mut turned, mut with_field) = (0.0, 0);
    let mut last = None;
    let mut still_at_first = 0;
    for entry in entries(turns()) {
        let Entry::Row(row) = entry else { continue };
        let counts = row.registers.expect("registers with every sample");
        with_field += u32::from(counts.field.is_some());
        let rate = ranges.sample::<f64>(&counts.sample).rate.rad_per_s();
        turned += rate.y.to_degrees() * 1e-3;
        let yaw = EulerAngles::of(row.sample.orientation).yaw.degrees();
        if row.sample.time < 2.9 {
            assert!(yaw.abs() < 0.5, "{yaw} at {} s", row.sample.time);
            still_at_first += 1;
        }
        if (4.1..4.4).contains(&row.sample.time) {
            last = Some((yaw, turned));
        }
    }
    assert!(still_at_first > 1000);
    let (yaw, turned) = last.expect("samples after the turn");
    assert!((yaw - 90.0).abs() < 1.0, "{yaw}");
    // The gyro's own bias is in its counts.
    assert!((turned - 90.0).abs() < 4.0, "{turned}");
    assert!((390..=410).contains(&with_field), "{with_field}");
}

#[test]
fn what_the_hub_passes_on_is_in_the_file_to_the_bit() {
    let choice = Choice::Emulated(Emulation::default());
    let (hub, updates) = Hub::open(choice, Some("counts"), Hold::All);
    let mut assembly = Assembly::new(true);
    let mut entries = Vec::new();
    let began = std::time::Instant::now();
    while samples(&entries).len() < 1500 {
        assert!(began.elapsed().as_secs() < 120, "{}", entries.len());
        if let Some(Update::Stream(items)) = updates.next(std::time::Duration::from_millis(100)) {
            for item in items.iter() {
                assembly.take(item, &mut entries);
            }
        }
    }
    drop(hub);
    assembly.complete(&mut entries);
    let head = Head {
        has_counts: true,
        ..Head::default()
    };
    let file = write("hub.csv", &head, &entries);
    assert_same(&entries, &self::entries(file.path()));
}

#[test]
fn nothing_is_written_over_unasked() {
    let file = Scratch::with("precious.csv", "precious");
    let refused = vrduino(&["record", "--emulate", "--seconds", "1", file.path()]);
    refused
        .expect(5)
        .said("is there already: choose another name, or --force");
    assert_eq!(fs::read_to_string(&file.0).expect("it"), "precious");
    let words = [
        "record",
        "--emulate",
        "--seconds",
        "0.2",
        "--force",
        file.path(),
    ];
    vrduino(&words)
        .expect(0)
        .said("samples in 0.2 s, none missing");
    assert!(samples(&entries(file.path())).len() > 200);
}

/// Even if it may go, it goes for a recording only, and never for its own.
#[test]
fn what_is_there_stays_where_nothing_takes_its_place() {
    let file = Scratch::with("kept.csv", "precious");
    for from in [["--replay", "no-such.csv"], ["--motion", "no-such.csv"]] {
        let mut words = vec!["record", "--force", file.path()];
        if from[0] == "--motion" {
            words.push("--emulate");
        }
        words.extend(from);
        vrduino(&words).expect(5).said("no-such.csv");
        assert_eq!(fs::read_to_string(&file.0).expect("it"), "precious");
    }
    let own = Scratch::with("own.csv", fs::read(turns()).expect("it"));
    let words = ["record", "--force", "--replay", own.path(), own.path()];
    vrduino(&words).expect(5).said("is what is read");
    assert_eq!(
        fs::read(&own.0).expect("it"),
        fs::read(turns()).expect("it")
    );
}

#[test]
fn what_cannot_be_made_is_not_begun() {
    let words = ["record", "--emulate", "no/such/folder/x.csv"];
    vrduino(&words).expect(5).said("there is no such folder");
    let words = ["record", "--emulate", env!("CARGO_TARGET_TMPDIR")];
    vrduino(&words).expect(5).said("is a folder: name a file");
    vrduino(&["record", "--seconds", "-1"]).expect(2);
    #[cfg(not(feature = "parquet"))]
    vrduino(&["record", "x.parquet"])
        .expect(5)
        .said("--features parquet");
}

#[test]
fn a_recording_of_a_recording_is_the_same() {
    let copy = Scratch::new("copy.csv");
    let words = [
        "record",
        "--counts",
        "--replay",
        turns(),
        "--speed",
        "1000",
        copy.path(),
    ];
    vrduino(&words).expect(0).said("none missing");
    let (one, other) = (samples(&entries(turns())), samples(&entries(copy.path())));
    assert_eq!(one.len(), other.len());
    for (one, other) in one.iter().zip(&other) {
        assert_eq!(one.sequence, other.sequence);
        assert_eq!(one.status, other.status);
        assert!((one.time - other.time).abs() < 2e-6, "{one:?}\n{other:?}");
        assert!(
            one.orientation.angle_to(&other.orientation) < 1e-8,
            "{one:?}\n{other:?}"
        );
    }
}
