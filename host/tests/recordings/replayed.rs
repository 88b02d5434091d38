//! A recording as a source, and `vrduino replay`.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use vrduino::wire::decoder::{Decoder, Event};
use vrduino_host::hub::{Hold, Hub, Subscription, Update};
use vrduino_host::recording::{Head, Player};
use vrduino_host::source::{Choice, Replay};
use vrduino_host::stream::{Item, Sample};

use crate::fixture::{Scratch, entries, row, samples, turned, turns, write};
use crate::program::vrduino;

/// Nothing here takes so long, even on a busy machine.
const LIMIT: Duration = Duration::from_secs(120);

fn open(path: &str, speed: f64, repeats: bool) -> (Hub, Subscription) {
    let path = PathBuf::from(path);
    let replay = Replay {
        path,
        speed,
        repeats,
    };
    Hub::open(Choice::Replay(replay), Some("binary"), Hold::All)
}

/// Until its end, or there are so many samples: these, the lines, and why it has ended.
fn watch(updates: &Subscription, count: usize) -> (Vec<Sample>, Vec<String>, Option<String>) {
    let began = Instant::now();
    let (mut samples, mut lines) = (Vec::new(), Vec::new());
    loop {
        assert!(began.elapsed() < LIMIT, "{} samples", samples.len());
        match updates.next(Duration::from_millis(100)) {
            Some(Update::Stream(items)) => {
                for item in items.iter() {
                    match item {
                        Item::Sample(sample) => samples.push(*sample),
                        Item::Line(line) => lines.push(line.clone()),
                        Item::Registers(_) => {}
                    }
                }
            }
            Some(Update::Ended(result)) => {
                let why = result.err().map(|failure| failure.sentence);
                return (samples, lines, why);
            }
            _ if samples.len() >= count => return (samples, lines, None),
            _ => {}
        }
    }
}

/// Registers, sequence numbers, delays: what comes out is what went in.
#[test]
fn downstream_nothing_is_different() {
    let (hub, updates) = open(turns(), 1000.0, false);
    let (played, lines, why) = watch(&updates, usize::MAX);
    assert_eq!(why, None);
    let recorded = samples(&entries(turns()));
    assert_eq!(played.len(), recorded.len());
    let began = played[0].arrival - recorded[0].arrival;
    for (one, other) in recorded.iter().zip(&played) {
        assert_eq!(one.sequence, other.sequence);
        assert_eq!(one.status, other.status);
        assert!((one.time - other.time).abs() < 2e-6, "{one:?}\n{other:?}");
        assert!(
            (other.arrival - one.arrival - began).abs() < 2e-6,
            "{one:?}\n{other:?}"
        );
        assert!(
            one.orientation.angle_to(&other.orientation) < 1e-8,
            "{one:?}\n{other:?}"
        );
    }
    // All delays are taken from the fastest, which are the same; the first of them are few.
    let late = |samples: &[Sample]| -> f64 {
        samples[1000..]
            .iter()
            .filter_map(|sample| sample.delay)
            .sum()
    };
    assert!(
        (late(&recorded) - late(&played)).abs() < 0.02,
        "{} {}",
        late(&recorded),
        late(&played)
    );
    let status = hub.status();
    assert_eq!((status.report.missing, status.report.restarts), (0, 0));
    assert_eq!(status.report.reconnections, 0);
    assert_eq!(status.version.as_deref(), Some("vrduino 0.1.0"));
    assert_eq!(status.settings["damping"], 0.5);
    let last = lines.last().expect("a line");
    assert!(last.starts_with("end of the recording: "), "{last}");
}

#[test]
fn whoever_wants_something_of_it_is_told_that_it_is_a_recording() {
    let (hub, _updates) = open(turns(), 0.01, false);
    let refused = hub.ask(":set tilt-time 2").expect_err("it cannot");
    assert!(
        refused
            .sentence
            .contains("this is a recording, which cannot be told anything"),
        "{refused}"
    );
}

#[test]
fn it_begins_again_when_that_is_asked_for() {
    let entries: Vec<_> = (0..300_u16)
        .map(|i| row(turned(f64::from(i) * 1e-3, i, 0.0)))
        .collect();
    let file = write("again.csv", &Head::default(), &entries);
    let (_hub, updates) = open(file.path(), 1000.0, true);
    let (samples, ..) = watch(&updates, 1000);
    let firsts = samples.iter().filter(|sample| sample.is_first).count();
    assert!(firsts >= 4, "{firsts}");
    assert!(samples.is_sorted_by_key(|sample| sample.arrival));
}

#[test]
fn a_cut_one_is_played_as_far_as_it_goes() {
    let text = std::fs::read(turns()).expect("it");
    let file = Scratch::with("played-cut.csv", &text[..text.len() / 2]);
    let (_hub, updates) = open(file.path(), 1000.0, false);
    let (samples, lines, why) = watch(&updates, usize::MAX);
    assert_eq!(why, None);
    assert!(samples.len() > 1000);
    let last = lines.last().expect("a line");
    assert!(last.contains("is cut off"), "{last}");
    let wrong = Scratch::with("played-wrong.csv", "7\n");
    let (_hub, updates) = open(wrong.path(), 1.0, false);
    let (.., why) = watch(&updates, usize::MAX);
    assert!(why.expect("a reason").contains("is no recording"));
}

#[test]
fn each_is_due_when_it_came() {
    let mut player = Player::open(Path::new(turns()), 4.0).expect("a recording");
    let recorded = samples(&entries(turns()));
    let mut played = Vec::new();
    while let Some(batch) = player.next_batch().expect("an entry") {
        for sample in samples(&batch.entries) {
            let due = (sample.arrival - recorded[0].arrival) / 4.0;
            assert!((batch.due.as_secs_f64() - due).abs() < 1e-6, "{batch:?}");
            played.push(sample);
        }
    }
    assert_eq!(played, recorded);
}

fn orientations(stream: &[u8]) -> Vec<(Option<u16>, f64)> {
    let mut decoder = Decoder::new();
    let mut found = Vec::new();
    for &byte in stream {
        if let Some(Event::Orientation(received)) = decoder.push(byte) {
            let sequence = received.stamp.map(|stamp| stamp.sequence);
            found.push((sequence, received.orientation.angle()));
        }
    }
    assert_eq!(decoder.losses().bytes, 0);
    found
}

#[test]
fn other_programs_have_it_as_lines_and_as_frames() {
    let recorded = samples(&entries(turns()));
    for (stream, has_numbers, off) in [("text", false, 2e-3), ("timed", true, 2e-3)] {
        let words = ["replay", turns(), "--speed", "1000", "--stream", stream];
        let ended = vrduino(&words);
        ended.expect(0).said("end of the recording");
        let found = orientations(ended.out.as_bytes());
        assert_eq!(found.len(), recorded.len());
        for (sample, (sequence, angle)) in recorded.iter().zip(found) {
            assert_eq!(sequence.is_some(), has_numbers);
            assert!(sequence.is_none() || sequence == sample.sequence);
            assert!(
                (sample.orientation.angle() - angle).abs() < off + 0.04,
                "{angle}"
            );
        }
    }
    vrduino(&["replay", "no-such.csv"])
        .expect(5)
        .said("there is no file");
    vrduino(&["replay", turns(), "--speed", "0"])
        .expect(2)
        .said("from 0.01 to 1000");
}

#[test]
fn other_programs_have_it_by_tcp() {
    let mut server = Command::new(env!("CARGO_BIN_EXE_vrduino"))
        .args([
            "replay",
            turns(),
            "--speed",
            "8",
            "--stream",
            "binary",
            "--tcp",
            "0",
        ])
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut said = BufReader::new(server.stderr.take().expect("a pipe"));
    let mut line = String::new();
    said.read_line(&mut line).expect("its address");
    let address = line.trim().strip_prefix("tcp     ").expect("an address");
    let mut stream = std::net::TcpStream::connect(address).expect("it listens");
    stream.set_read_timeout(Some(LIMIT)).expect("a limit");
    let mut bytes = Vec::new();
    stream.read_to_end(&mut bytes).expect("its stream");
    let numbers: Vec<_> = orientations(&bytes).iter().map(|found| found.0).collect();
    let recorded = samples(&entries(turns()));
    let expected: Vec<_> = recorded.iter().map(|sample| sample.sequence).collect();
    assert_eq!(numbers, expected);
    assert!(server.wait().expect("its end").success());
}

#[test]
fn a_reader_who_has_enough_is_no_failure() {
    let mut program = Command::new(env!("CARGO_BIN_EXE_vrduino"))
        .args(["replay", turns(), "--speed", "1000"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let mut first = [0; 10];
    let mut out = program.stdout.take().expect("a pipe");
    out.read_exact(&mut first).expect("some of it");
    drop(out);
    assert!(program.wait().expect("its end").success());
}

#[test]
fn monitor_reads_one_to_its_end() {
    let words = ["monitor", "--replay", turns(), "--speed", "100"];
    let ended = vrduino(&words);
    ended.expect(0);
    assert!(!ended.out.is_empty(), "{}", ended.err);
}

#[test]
fn whoever_reads_one_that_is_not_whole_is_told() {
    let text = std::fs::read(turns()).expect("it");
    let cut = Scratch::with("told-cut.csv", &text[..text.len() / 2]);
    let again = Scratch::new("told-again.csv");
    let monitored = vrduino(&["monitor", "--replay", cut.path(), "--speed", "100"]);
    assert!(monitored.out.contains("is cut off"), "{monitored:?}");
    assert!(
        !monitored.out.contains("the stream is sound"),
        "{monitored:?}"
    );
    let words = [
        "record",
        "--replay",
        cut.path(),
        "--speed",
        "100",
        again.path(),
    ];
    vrduino(&words).expect(0).said("is cut off");
}
