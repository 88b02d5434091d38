//! Recordings in columns.

use std::fs;
use std::path::Path;

use vrduino_host::recording::{self, Head, Reader};

use crate::fixture::{Random, Scratch, assert_same, entries, read, turns, write};
use crate::program::vrduino;

fn convert(from: &str, to: &Scratch) {
    let mut reader = Reader::open(Path::new(from)).expect("a recording");
    recording::parquet::write(&mut reader, &to.0).expect("it is written");
}

#[test]
fn columns_hold_the_same_as_lines() {
    let columns = Scratch::new("turns.parquet");
    convert(turns(), &columns);
    let one = Reader::open(Path::new(turns())).expect("lines");
    let other = Reader::open(&columns.0).expect("columns");
    assert_eq!(one.head(), other.head());
    assert_same(&entries(turns()), &entries(columns.path()));
    let size = |path: &str| fs::metadata(path).expect("a file").len();
    assert!(size(columns.path()) < size(turns()) / 2);
}

#[test]
fn anything_comes_back_as_it_was() {
    let mut random = Random(3);
    // More than a group of rows, and none.
    for (count, has_counts) in [(70_000, true), (100, false), (0, true)] {
        let mut all = Vec::new();
        for round in 0..count {
            let is_first = random.bits().is_multiple_of(4096);
            all.push(random.entry(f64::from(round) * 1e-3, is_first));
        }
        let head = Head {
            has_counts,
            ..Head::default()
        };
        let lines = write(&format!("anything-{count}.csv"), &head, &all);
        let columns = Scratch::new(&format!("anything-{count}.parquet"));
        convert(lines.path(), &columns);
        assert_same(&entries(lines.path()), &entries(columns.path()));
    }
}

#[test]
fn it_is_recorded_as_lines_and_ends_as_columns() {
    let file = Scratch::new("recorded.parquet");
    let words = ["record", "--emulate", "--seconds", "0.5", file.path()];
    vrduino(&words)
        .expect(0)
        .said("samples in 0.5 s, none missing");
    assert!(entries(file.path()).len() > 500);
    assert!(!Path::new(&format!("{}.csv", file.path())).exists());
    vrduino(&words).expect(5).said("is there already");
    let named = Scratch::new("recorded.data");
    let words = [
        "record",
        "--replay",
        file.path(),
        "--speed",
        "1000",
        "--format",
        "parquet",
    ];
    let words: Vec<_> = words.into_iter().chain([named.path()]).collect();
    vrduino(&words).expect(0);
    assert!(fs::read(&named.0).expect("it").starts_with(b"PAR1"));
}

#[test]
fn a_damaged_one_is_told() {
    let columns = Scratch::new("damaged.parquet");
    convert(turns(), &columns);
    let whole = fs::read(&columns.0).expect("it");
    let mut random = Random(4);
    for round in 0..60 {
        let mut bytes = whole.clone();
        match round % 2 {
            0 => bytes.truncate(4 + random.bits() as usize % (whole.len() - 4)),
            _ => {
                let place = 4 + random.bits() as usize % (whole.len() - 4);
                bytes[place] ^= 1 << (random.bits() % 8);
            }
        }
        let file = Scratch::with(&format!("damaged-{round}.parquet"), &bytes);
        match Reader::open(&file.0) {
            Ok(mut reader) => while let Ok(Some(_)) = reader.read() {},
            Err(failure) => assert!(
                failure.sentence.contains("damaged") || failure.sentence.contains("no recording"),
                "{failure}"
            ),
        }
    }
    let (all, _) = read(columns.path());
    assert!(all.len() > 4000);
}
