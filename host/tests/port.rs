//! Promise: whatever happens to a serial port, the stream goes on after it, and what was wrong is said.
#![cfg(unix)]

mod pty;

use std::io::{Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use pty::{PluggedIn, Port, Pty};
use vrduino_host::hub::{Hold, Hub, State, Status, Subscription, Update};
use vrduino_host::source::Choice;
use vrduino_host::stream::{Item, Sample};

/// Nothing here takes so long, even on a busy machine.
const LIMIT: Duration = Duration::from_secs(60);

fn open(path: &str) -> (Hub, Subscription) {
    let hub = Hub::start(Choice::Port(Some(path.to_owned())), Some("binary"));
    let updates = hub.subscribe(Hold::All);
    (hub, updates)
}

fn samples(updates: &Subscription, count: usize) -> Vec<Sample> {
    let began = Instant::now();
    let mut found = Vec::new();
    while found.len() < count {
        assert!(
            began.elapsed() < LIMIT,
            "only {} samples of {count} have come",
            found.len()
        );
        if let Some(Update::Stream(items)) = updates.next(Duration::from_millis(100)) {
            found.extend(items.iter().filter_map(|item| match item {
                Item::Sample(sample) => Some(*sample),
                _ => None,
            }));
        }
    }
    found
}

fn status(updates: &Subscription, wanted: impl Fn(&Status) -> bool) -> Arc<Status> {
    let began = Instant::now();
    let mut last = None;
    while began.elapsed() < LIMIT {
        if let Some(Update::Status(status)) = updates.next(Duration::from_millis(100)) {
            if wanted(&status) {
                return status;
            }
            last = Some(status);
        }
    }
    panic!("it stays at {last:#?}");
}

#[test]
fn a_board_is_introduced_and_left_as_it_was_found() {
    let board = PluggedIn::new(Vec::new);
    let (hub, updates) = open(&board.path);
    let known = status(&updates, |status| status.settings.len() == 7);
    assert_eq!(known.version.as_deref(), Some("vrduino 0.1.0"));
    assert_eq!(known.estimator.as_deref(), Some("default"));
    assert_eq!(known.stream.as_deref(), Some("binary every 1"));
    let answer = hub.ask(":set notes-alpha 0.99").expect("an answer");
    assert!(answer.starts_with("notes-alpha 0.99"), "{answer}");
    // The same thing by another name.
    status(&updates, |status| status.settings["notes-time"] < 0.2);
    let refused = hub
        .ask(":set tilt-time 1000")
        .expect_err("beyond its range");
    assert!(refused.sentence.contains("ERR"), "{refused}");
    assert!(
        samples(&updates, 100)
            .iter()
            .all(|sample| sample.sequence.is_some())
    );
    drop(hub);
    let hub = Hub::start(Choice::Port(Some(board.path.clone())), None);
    assert_eq!(
        hub.ask(":stream").expect("an answer"),
        "stream text every 10"
    );
}

#[test]
fn garbage_is_thrown_away_and_counted() {
    let (mut state, mut calls) = (1_u32, 0);
    let board = PluggedIn::new(move || {
        calls += 1;
        // Every 20 ms some bytes of anything, zeros and newlines among them.
        let count = if calls % 20 == 0 { calls / 20 % 60 } else { 0 };
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        (0..count).map(|_| next()).collect()
    });
    let (hub, updates) = open(&board.path);
    let mut last = None;
    for sample in samples(&updates, 3000)
        .into_iter()
        .filter(|sample| sample.sequence.is_some())
    {
        if let Some(last) = last.replace(sample.time) {
            assert!(sample.time > last, "{} s after {last} s", sample.time);
        }
    }
    let report = hub.status_now().report;
    assert!(report.bytes > 500, "{report:?}");
    assert!(report.malformed + report.damaged > 10, "{report:?}");
    assert_eq!(report.restarts, 0, "{report:?}");
}

#[test]
fn a_port_in_use_says_so() {
    let board = PluggedIn::new(Vec::new);
    let (_hub, updates) = open(&board.path);
    samples(&updates, 1);
    let (_second, updates) = open(&board.path);
    let busy = status(&updates, |status| status.trouble.is_some());
    assert_eq!(busy.state, State::Waiting);
    let trouble = busy.trouble.clone().expect("trouble");
    assert!(
        trouble.sentence.contains("in use by another program"),
        "{trouble}"
    );
    drop(_hub);
    // As soon as the other has gone.
    status(&updates, |status| status.state == State::Connected);
}

#[test]
fn a_board_that_comes_back_goes_on() {
    let port = Port::new();
    let board = PluggedIn::new(Vec::new);
    port.plug(&board);
    let (hub, updates) = open(port.path());
    samples(&updates, 100);
    port.pull(board);
    let lost = status(&updates, |status| status.state == State::Lost);
    assert!(lost.trouble.is_some());
    assert_eq!(lost.estimator, None);
    let board = PluggedIn::new(Vec::new);
    port.plug(&board);
    status(&updates, |status| status.state == State::Connected);
    let again = samples(&updates, 100);
    assert!(again[0].is_first);
    assert!(again[1..].iter().all(|sample| !sample.is_first));
    status(&updates, |status| {
        status.stream.as_deref() == Some("binary every 1")
    });
    assert_eq!(hub.status().report.reconnections, 1);
}

/// The course's firmware takes single letters for keys, `b` for a measurement of three seconds.
#[test]
fn another_program_is_sent_nothing_that_it_could_take_for_a_key() {
    let Pty { mut device, path } = Pty::open();
    let wanted = Arc::new(AtomicBool::new(true));
    let flag = Arc::clone(&wanted);
    let course = thread::spawn(move || {
        let mut typed = Vec::new();
        while flag.load(Ordering::Relaxed) {
            let _ = device.write(b"QC 0.707 0.000 0.707 0.000\n");
            let mut bytes = [0; 64];
            if let Ok(count) = device.read(&mut bytes) {
                typed.extend_from_slice(&bytes[..count]);
            }
            thread::sleep(Duration::from_millis(10));
        }
        let mut rest = [0; 64];
        while let Ok(count @ 1..) = device.read(&mut rest) {
            typed.extend_from_slice(&rest[..count]);
        }
        typed
    });
    let (hub, updates) = open(&path);
    let angle = samples(&updates, 10)[9].orientation.angle().to_degrees();
    assert!((angle - 90.0).abs() < 1e-9);
    let strange = status(&updates, |status| status.trouble.is_some());
    assert_eq!(strange.state, State::Connected);
    assert!(hub.ask(":set tilt-time 2").is_err());
    hub.press(b"5");
    status(&updates, |_| true);
    drop(hub);
    wanted.store(false, Ordering::Relaxed);
    let typed = course.join().expect("typed");
    let keys: Vec<u8> = typed
        .into_iter()
        .filter(|byte| b"012345rb".contains(byte))
        .collect();
    assert_eq!(keys, b"5");
}
