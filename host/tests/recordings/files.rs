//! What is written is read, and what is not right is told.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use vrduino_host::failure::Kind;
use vrduino_host::recording::{Entry, Head, Reader};

use crate::fixture::{Random, Scratch, assert_same, entries, read, row, samples, turned, write};

fn head(has_counts: bool) -> Head {
    Head {
        started: "2026-11-22T16:41:52+01:00".into(),
        source: "tcp:127.0.0.1:5000, by day".into(),
        board: Some("vrduino 0.1.0".into()),
        estimator: Some("default".into()),
        stream: Some("counts every 1".into()),
        settings: BTreeMap::from([("damping".into(), 0.1 + 0.2), ("lead".into(), -1e-9)]),
        has_counts,
    }
}

/// How many samples of it can be read, and what is said of the rest.
fn salvaged(content: impl AsRef<[u8]>, name: &str) -> (u64, String) {
    let file = Scratch::with(name, content);
    let mut reader = Reader::open(&file.0).expect("its head is right");
    while reader.read().expect("it can be read").is_some() {}
    let warning = reader.warning().expect("something is wrong with it");
    (reader.ending().samples, warning)
}

fn short() -> String {
    let samples = (0..12_u16).map(|i| row(turned(f64::from(i) * 1e-3, i, f64::from(i))));
    let samples: Vec<_> = samples.collect();
    let file = write("short.csv", &head(false), &samples);
    fs::read_to_string(&file.0).expect("text")
}

#[test]
fn anything_comes_back_as_it_was() {
    let mut random = Random(1);
    let mut entries: Vec<Entry> = Vec::new();
    for round in 0..3000 {
        let is_first = entries.is_empty() || random.bits().is_multiple_of(256);
        entries.push(random.entry(f64::from(round) * 0.012_345_678, is_first));
    }
    // The first row begins a segment whatever is said of it.
    let first = entries.iter_mut().find_map(|entry| match entry {
        Entry::Row(row) => Some(row),
        Entry::Remark(_) => None,
    });
    first.expect("a row").sample.is_first = true;
    let file = write("anything.csv", &head(true), &entries);
    let mut reader = Reader::open(&file.0).expect("a recording");
    assert_eq!(reader.head(), &head(true));
    assert_same(&entries, &self::entries(file.path()));
    while reader.read().expect("an entry").is_some() {}
    assert_eq!(reader.ending().samples, samples(&entries).len() as u64);
    // Without their column the registers are not there, and all else is.
    let file = write("anything-plain.csv", &head(false), &entries);
    for entry in &mut entries {
        if let Entry::Row(row) = entry {
            row.registers = None;
        }
    }
    assert_same(&entries, &self::entries(file.path()));
}

#[test]
fn cut_off_anywhere_it_gives_what_is_whole_and_says_so() {
    let whole = short();
    let head = whole.find("\ntime_s").expect("a header");
    let rows = head + whole[head + 1..].find('\n').expect("an end") + 2;
    for cut in 0..whole.len() {
        let part = &whole[..cut];
        let file = Scratch::with(&format!("cut-{cut}.csv"), part);
        if cut < rows {
            let failure = Reader::open(&file.0).expect_err("nothing is in it");
            assert!(
                failure.sentence.contains("cut off before its first sample"),
                "{cut}: {failure}"
            );
            continue;
        }
        let (entries, warning) = read(file.path());
        let expected = part[rows..].matches('\n').count();
        assert_eq!(entries.len(), expected.min(12), "{cut}");
        // All but its very last byte is all of it.
        if cut == whole.len() - 1 {
            assert_eq!(warning, None);
        } else {
            let warning = warning.expect("it is cut off");
            assert!(
                warning.contains(&format!("its {expected} samples of")),
                "{cut}: {warning}"
            );
        }
    }
}

#[test]
fn what_is_no_recording_is_told() {
    let whole = short();
    let header = whole.lines().find(|l| l.starts_with("time_s")).expect("it");
    let cases = [
        (
            whole.replacen("recording 1\n", "recording 2\n", 1),
            "a recording of version 2, and this program reads version 1",
        ),
        (String::from("t,gx,gy,gz\n1,2,3,4\n"), "is no recording"),
        ("1".repeat(5000), "is no recording"),
        (
            whole.replacen(header, "time,w,x,y,z", 1),
            "the columns should be time_s,arrival_s",
        ),
    ];
    for (number, (content, expected)) in cases.iter().enumerate() {
        let file = Scratch::with(&format!("wrong-{number}.csv"), content);
        let failure = Reader::open(&file.0).expect_err(expected);
        assert_eq!(failure.kind, Kind::File);
        assert!(failure.sentence.contains(expected), "{expected}: {failure}");
    }
}

/// The line is named, and all others are read.
#[test]
fn a_damaged_line_takes_nothing_else_with_it() {
    let whole = short();
    let lines: Vec<_> = whole.lines().collect();
    let first = 1 + lines
        .iter()
        .position(|l| l.starts_with("time_s"))
        .expect("it");
    let with = |damaged: &[u8]| {
        let mut bytes = Vec::new();
        for (place, line) in lines.iter().enumerate() {
            let line = if place == first {
                damaged
            } else {
                line.as_bytes()
            };
            bytes.extend([line, b"\n"].concat());
        }
        bytes
    };
    let row = "0.001,0.004,0,1,1,0,0,0,0.1,0,0,0,unused,0,0,0";
    let cases = [
        (
            "rubbish".into(),
            "time_s should be a number, and is `rubbish`",
        ),
        (
            row.replace("0.001", "nan"),
            "time_s should be a number, and is `nan`",
        ),
        (row.replace("0.001", "1e300"), "time_s cannot be 1"),
        (
            row.replace("unused", "on"),
            "compass should be absent, unused",
        ),
        (
            row.replace("1,1,0,0,0", "70000,1,0,0,0"),
            "sequence cannot be 70000",
        ),
        (
            row.replace("1,1,0,0,0", "1,3,0,0,0"),
            "a quaternion of length 1",
        ),
        (
            row.replace("0,0,0,unused", ",0,0,unused"),
            "repeated is missing",
        ),
        ("1,2,3".into(), "16 fields are expected, and 3 are there"),
        (
            format!("{row},7"),
            "16 fields are expected, and 17 are there",
        ),
        ("1".repeat(5000), "no line of a recording is so long"),
        ("1".repeat(50_000), "no line of a recording is so long"),
    ];
    let at = format!("line {}: ", first + 1);
    for (number, (damaged, expected)) in cases.iter().enumerate() {
        let name = format!("damaged-{number}.csv");
        let (samples, warning) = salvaged(with(damaged.as_bytes()), &name);
        assert!(warning.contains(&at), "{warning}");
        assert!(warning.contains(expected), "{expected}: {warning}");
        assert!(
            warning.contains("the 11 samples that are whole"),
            "{warning}"
        );
        assert_eq!(samples, 11, "{warning}");
    }
    let (samples, warning) = salvaged(with(b"\xFF\xFE"), "bytes.csv");
    assert_eq!(samples, 11);
    assert!(warning.contains("text is expected"), "{warning}");
}

#[test]
fn rows_that_are_too_many_or_too_few_are_told() {
    let whole = short();
    let row = "0.001,0.004,0,1,1,0,0,0,0.1,0,0,0,unused,0,0,0\n";
    let (samples, warning) = salvaged(whole.clone() + row + row, "behind.csv");
    assert_eq!(samples, 12);
    assert!(
        warning.contains("nothing should be behind the end marker (and one more line)"),
        "{warning}"
    );
    let (samples, warning) = salvaged(whole.replacen("# end, 12", "# end, 13", 1), "fewer.csv");
    assert_eq!(samples, 12);
    assert!(
        warning.contains("it should hold 13 samples, and holds 12"),
        "{warning}"
    );
    let (samples, warning) = salvaged(whole.replacen("# end, 12", "# end, 11", 1), "more.csv");
    assert_eq!(samples, 12);
    assert!(
        warning.contains("it should hold 11 samples, and holds 12"),
        "{warning}"
    );
}

/// As some editors save it.
#[test]
fn a_byte_order_mark_and_other_line_ends_do_no_harm() {
    let windows = format!("\u{FEFF}{}", short().replace('\n', "\r\n"));
    let file = Scratch::with("windows.csv", windows);
    assert_eq!(samples(&entries(file.path())).len(), 12);
}

#[test]
fn garbage_never_panics() {
    let whole = short().into_bytes();
    let mut random = Random(2);
    for round in 0..400 {
        let mut bytes = whole.clone();
        for _ in 0..1 + random.bits() % 8 {
            let place = random.bits() as usize % bytes.len();
            match random.bits() % 3 {
                0 => bytes[place] = random.bits() as u8,
                1 if bytes.len() > 1 => drop(bytes.remove(place)),
                _ => bytes.truncate(place.max(1)),
            }
        }
        let file = Scratch::with(&format!("garbage-{round}.csv"), &bytes);
        if let Ok(mut reader) = Reader::open(&file.0) {
            while let Ok(Some(_)) = reader.read() {}
            assert!(reader.ending().samples <= 13);
        }
    }
}

#[test]
fn what_is_not_there_says_so() {
    let missing = Reader::open(Path::new("no/such.csv")).expect_err("there is none");
    assert_eq!(missing.sentence, "there is no file no/such.csv");
    let folder = Reader::open(Path::new(env!("CARGO_TARGET_TMPDIR"))).expect_err("a folder");
    assert_eq!(folder.kind, Kind::File);
}
