//! What is written is read, and what is not right is told.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use vrduino_host::failure::{Failure, Kind};
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

/// Whatever there is wrong with it.
fn failure(content: impl AsRef<[u8]>, name: &str) -> Failure {
    let file = Scratch::with(name, content);
    let mut reader = match Reader::open(&file.0) {
        Ok(reader) => reader,
        Err(failure) => return failure,
    };
    loop {
        match reader.read() {
            Ok(Some(_)) => {}
            Ok(None) => panic!("nothing is wrong with it: {:?}", reader.ending()),
            Err(failure) => return failure,
        }
    }
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
        let name = format!("cut-{cut}.csv");
        let part = &whole[..cut];
        if cut < rows {
            let failure = failure(part, &name);
            assert!(
                failure.sentence.contains("cut off before its first sample"),
                "{cut}: {failure}"
            );
            continue;
        }
        let file = Scratch::with(&name, part);
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
fn what_is_no_recording_is_told_where_and_why() {
    let whole = short();
    let put = |from: &str, to: &str| whole.replacen(from, to, 1);
    let line = |number: usize, text: &str| {
        let mut lines: Vec<_> = whole.lines().collect();
        lines[number - 1] = text;
        lines.join("\n") + "\n"
    };
    let header = 1 + whole
        .lines()
        .position(|l| l.starts_with("time_s"))
        .expect("it");
    let first = header + 1;
    let at = format!("line {first}: ");
    let long = "1".repeat(5000);
    let row = "0.001,0.004,0,1,1,0,0,0,0.1,0,0,0,unused,0,0,0";
    let cases = [
        (
            put("recording 1\n", "recording 2\n"),
            "a recording of version 2, and this program reads version 1",
        ),
        (String::from("t,gx,gy,gz\n1,2,3,4\n"), "is no recording"),
        (long.clone(), "is no recording"),
        (
            line(header, "time,w,x,y,z"),
            "the columns should be time_s,arrival_s",
        ),
        (
            line(first, "rubbish"),
            "time_s should be a number, and is `rubbish`",
        ),
        (
            line(first, &row.replace("0.001", "nan")),
            "time_s should be a number, and is `nan`",
        ),
        (
            line(first, &row.replace("0.001", "1e300")),
            "time_s cannot be 1",
        ),
        (
            line(first, &row.replace("unused", "on")),
            "compass should be absent, unused",
        ),
        (
            line(first, &row.replace("1,1,0,0,0", "70000,1,0,0,0")),
            "sequence cannot be 70000",
        ),
        (
            line(first, &row.replace("1,1,0,0,0", "1,3,0,0,0")),
            "a quaternion of length 1",
        ),
        (
            line(first, &row.replace("0,0,0,unused", ",0,0,unused")),
            "repeated is missing",
        ),
        (
            line(first, "1,2,3"),
            "16 fields are expected, and 3 are there",
        ),
        (
            line(first, &format!("{row},7")),
            "16 fields are expected, and 17 are there",
        ),
        (line(first, &long), "no line of a recording is so long"),
        (
            whole.clone() + row + "\n",
            "nothing should be behind the end marker",
        ),
        (
            put("# end, 12", "# end, 13"),
            "it should hold 13 samples, and holds 12",
        ),
    ];
    for (number, (content, expected)) in cases.iter().enumerate() {
        let failure = failure(content, &format!("wrong-{number}.csv"));
        assert_eq!(failure.kind, Kind::File);
        assert!(failure.sentence.contains(expected), "{expected}: {failure}");
        if content.lines().nth(first - 1) != whole.lines().nth(first - 1) && number > 3 {
            assert!(failure.sentence.contains(&at), "{failure}");
        }
    }
    let mut bytes = whole.clone().into_bytes();
    let place = bytes.len() - 30;
    bytes[place] = 0xFF;
    let failure = failure(&bytes, "bytes.csv");
    assert!(failure.sentence.contains("text is expected"), "{failure}");
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
