//! A run in words.

use std::io::{self, Write};
use std::sync::{Arc, Mutex};

use vrduino_emulator::board::Board;
use vrduino_emulator::time::{self, NEVER};
use vrduino_emulator::trace::{Topic, Trace};

use crate::tracker::{board, run, setup};

/// A file that stays in memory.
#[derive(Clone, Default)]
pub struct Paper(Arc<Mutex<Vec<u8>>>);

impl Paper {
    pub fn text(&self) -> String {
        String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
    }
}

impl Write for Paper {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn traced(topics: &[Topic], from: f64, until: f64, seconds: f64) -> (Board, String) {
    let paper = Paper::default();
    let mut board = board(setup());
    let (from, until) = (time::ticks(from), time::ticks(until));
    board.watch(Box::new(Trace::new(paper.clone(), topics, from, until)));
    run(&mut board, seconds);
    board.finish_watching().unwrap();
    (board, paper.text())
}

#[test]
fn a_trace_names_registers_places_transactions_and_interrupts() {
    let (board, text) = traced(&Topic::ALL, 0.0, f64::INFINITY, 0.3);
    let has = |parts: &[&str]| {
        let found = text
            .lines()
            .any(|line| parts.iter().all(|part| line.contains(part)));
        assert!(found, "no line with {parts:?}");
    };
    has(&["registers", "WDOG_UNLOCK <- 0xc520", "__pre_init"]);
    has(&["registers", "I2C0_C1 <- ", "IICEN", "MST"]);
    has(&["registers", "MCG_S -> ", "PLLST", "LOCK0"]);
    has(&["the same", "times more"]);
    has(&["i2c", "0x68 write [75] read [71]"]);
    has(&["i2c", "0x68 write, no answer"]);
    has(&["usb", "bus reset"]);
    has(&["usb", "SETUP ep0 GET_DESCRIPTOR device length 64 ACK"]);
    has(&["usb", "IN ep0 DATA1 18 bytes [12 01", "ACK"]);
    has(&["usb", "NAKs)"]);
    has(&["interrupts", "enter USBOTG (73) after ", " µs"]);
    has(&["interrupts", "leave I2C0 (24)"]);
    has(&["interrupts", "sleep"]);
    // One enter for each leave, and as many as were measured.
    let count = |word: &str| text.lines().filter(|line| line.contains(word)).count();
    assert_eq!(count("  enter "), count("  leave "));
    let entries: u64 = board.measure().latencies.iter().map(|one| one.count).sum();
    assert_eq!(count("  enter "), entries as usize);
}

#[test]
fn a_trace_keeps_to_its_topics_and_its_time() {
    let (_, text) = traced(&[Topic::I2c], 0.2, 0.25, 0.3);
    assert!(text.lines().count() > 10, "{text}");
    for line in text.lines() {
        let mut words = line.split_whitespace();
        let at: f64 = words.next().unwrap().parse().unwrap();
        assert!((0.2..0.25).contains(&at), "{line}");
        assert_eq!(words.next(), Some("i2c"), "{line}");
    }
}

#[test]
fn being_watched_changes_nothing() {
    let (watched, _) = traced(&Topic::ALL, 0.0, f64::INFINITY, 0.5);
    let mut alone = board(setup());
    run(&mut alone, 0.5);
    assert_eq!(watched.state_hash(), alone.state_hash());
}

#[test]
fn a_trace_that_cannot_be_written_is_an_error() {
    struct Full;
    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let mut board = board(setup());
    board.watch(Box::new(Trace::new(Full, &Topic::ALL, 0, NEVER)));
    run(&mut board, 0.01);
    let error = board.finish_watching().unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::StorageFull);
}
