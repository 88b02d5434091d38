//! What the page of `vrduino view` is told, and what it can have done.

use nalgebra::{Quaternion, UnitQuaternion};
use serde_json::Value;
use tungstenite::Message;
use vrduino_emulator::firmware::{self, BuildOptions};

use crate::client::{Stream, a_while, view};
use crate::program::place;
use crate::server::Server;

const HEADER: usize = 4;
const RECORD: usize = 40;

/// Bits of the flags.
const NOTES: u32 = 1 << 5;
const STATUS_KNOWN: u32 = 1 << 8;
const OF_DEVICE: u32 = 1 << 9;
const FIRST: u32 = 1 << 10;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    time: f64,
    q: [f32; 4],
    latency: f32,
    sequence: u32,
    flags: u32,
}

impl Sample {
    fn orientation(&self) -> UnitQuaternion<f64> {
        rotation(self.q.map(f64::from))
    }
}

fn rotation([w, x, y, z]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

/// Takes a batch apart by the document's table.
fn batch(message: &Message) -> Option<Vec<Sample>> {
    let Message::Binary(bytes) = message else {
        return None;
    };
    let count = usize::from(u16::from_le_bytes([bytes[2], bytes[3]]));
    assert_eq!(bytes[..2], [1, 1], "kind and version");
    assert_eq!(bytes.len(), HEADER + count * RECORD);
    assert!(count > 0, "an empty batch");
    let record = |bytes: &[u8]| {
        let f32 = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four"));
        let u32 = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four"));
        assert_eq!(u32(36), 0);
        Sample {
            time: f64::from_le_bytes(bytes[..8].try_into().expect("eight")),
            q: [f32(8), f32(12), f32(16), f32(20)],
            latency: f32(24),
            sequence: u32(28),
            flags: u32(32),
        }
    };
    Some(bytes[HEADER..].chunks(RECORD).map(record).collect())
}

fn json(message: &Message) -> Option<Value> {
    serde_json::from_str(message.to_text().ok().filter(|_| message.is_text())?).ok()
}

/// The next status of which this is true.
fn status(stream: &mut Stream, what: &str, wanted: impl Fn(&Value) -> bool) -> Value {
    stream.find(what, |message| {
        json(message).filter(|value| value["type"] == "status" && wanted(value))
    })
}

/// The next line that begins so.
fn line(stream: &mut Stream, start: &str) -> String {
    stream.find(start, |message| {
        let value = json(message).filter(|value| value["type"] == "line")?;
        let text = value["text"].as_str()?;
        text.starts_with(start).then(|| text.to_owned())
    })
}

/// The next samples, so many at least.
fn samples(stream: &mut Stream, count: usize) -> Vec<Sample> {
    let mut found = Vec::new();
    while found.len() < count {
        found.extend(stream.find("samples", batch));
    }
    found
}

#[test]
fn samples_come_whole_and_stand_as_the_sensor_does() {
    let program = Server::view(&["--emulate"]);
    let mut page = view(program.port);
    let first = status(&mut page, "the first status", |_| true);
    assert_eq!(first["kind"], "emulated");
    assert_eq!(first["motions"][0], "head");
    assert_eq!(first["motion"], "head");
    let mut all: Vec<Sample> = Vec::new();
    let mut compared = 0;
    page.find("20 comparisons with the truth", |message| {
        if let Some(found) = batch(message) {
            all.extend(found);
        }
        let truth = json(message).filter(|value| value["type"] == "truth")?;
        let t = truth["t"].as_f64()?;
        let q: [f64; 4] = serde_json::from_value(truth["q"].clone()).ok()?;
        // From when on the head turns.
        if t < 4.0 {
            return None;
        }
        let sample = all.iter().min_by(|a, b| {
            let apart = |sample: &Sample| (sample.time - t).abs();
            apart(a).total_cmp(&apart(b))
        })?;
        assert!((sample.time - t).abs() < 0.05, "{sample:?} at {t} s");
        let off = sample.orientation().angle_to(&rotation(q)).to_degrees();
        assert!(off < 5.0, "{off} deg off the truth at {t} s");
        compared += 1;
        (compared >= 20).then_some(())
    });
    let binary: Vec<_> = all
        .iter()
        .filter(|sample| sample.flags & OF_DEVICE != 0)
        .collect();
    assert!(binary.len() > 1000, "{}", binary.len());
    for pair in binary.windows(2) {
        assert_eq!(pair[1].sequence, (pair[0].sequence + 1) % 65536, "{pair:?}");
        let step = pair[1].time - pair[0].time;
        // Of `:stream text` there was a sample in ten until it was asked for frames.
        assert!((0.0005..0.0015).contains(&step), "{pair:?}");
    }
    for sample in binary {
        let length = sample.q.iter().map(|part| part * part).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-6, "{sample:?}");
        assert!(sample.latency >= 0.0, "{sample:?}");
        assert!(sample.flags & STATUS_KNOWN != 0, "{sample:?}");
    }
    let known = status(&mut page, "a rate", |status| {
        status["rate"].as_f64() > Some(900.0)
    });
    assert_eq!(known["state"], "connected");
    assert_eq!(known["estimator"], "default");
    assert_eq!(known["settings"]["tilt-time"], 3.0);
    assert_eq!(known["dropped"], 0);
    assert!(known["latency_ms"]["p50"].as_f64() <= known["latency_ms"]["p99"].as_f64());
}

#[test]
fn commands_reach_the_board_and_the_status_says_so() {
    let program = Server::view(&["--emulate", "--motion", "still"]);
    let mut page = view(program.port);
    status(&mut page, "settings", |status| {
        status["settings"]["notes-time"].is_number()
    });
    page.say(r#"{"send":":set tilt-time 2.5"}"#);
    assert_eq!(line(&mut page, "OK tilt-time"), "OK tilt-time 2.5000 s");
    status(&mut page, "the new one", |status| {
        status["settings"]["tilt-time"] == 2.5
    });
    page.say(r#"{"send":":estimator notes"}"#);
    status(&mut page, "the other", |status| {
        status["estimator"] == "notes"
    });
    page.find("samples of the other", |message| {
        let last = *batch(message)?.last()?;
        (last.flags & NOTES != 0).then_some(())
    });
    page.say(r#"{"send":":set notes-time 1"}"#);
    // The board moves the one with the other.
    status(&mut page, "both", |status| {
        status["settings"]["notes-alpha"].as_f64() < Some(0.9995)
            && status["settings"]["notes-time"] == 1.0
    });
    page.say(r#"{"send":":set tilt-time -1"}"#);
    line(&mut page, "ERR ");
    page.say(r#"{"send":"b"}"#);
    line(&mut page, "Measuring bias");
}

#[test]
fn what_makes_no_sense_is_answered_and_not_passed_on() {
    let program = Server::view(&["--emulate", "--motion", "still"]);
    let mut page = view(program.port);
    status(&mut page, "the board", |status| {
        status["state"] == "connected"
    });
    let long = format!(r#"{{"send":":{}"}}"#, "x".repeat(73));
    for message in [
        "",
        "nonsense",
        "[]",
        r#"{"bogus":1}"#,
        r#"{"send":5}"#,
        r#"{"send":""}"#,
        r#"{"send":"rr"}"#,
        r#"{"send":"\u0000"}"#,
        r#"{"send":":set\n0"}"#,
        r#"{"send":":µ"}"#,
        r#"{"start":"something"}"#,
        r#"{"motion":"/etc/passwd"}"#,
        r#"{"turn":[1,0,0]}"#,
        r#"{"send":"r","stop":true}"#,
        &long,
    ] {
        page.say(message);
        line(&mut page, "error: ");
    }
    // Too long to be of a page of ours: that one is let go, others stay.
    let mut other = view(program.port);
    // It may be gone before all of it went out.
    let _ = other.try_say(&"x".repeat(100_000));
    let mut third = view(program.port);
    assert!(!samples(&mut third, 100).is_empty());
    assert!(!samples(&mut page, 100).is_empty());
}

#[test]
fn the_cable_is_pulled_and_put_back() {
    let program = Server::view(&["--emulate", "--motion", "still"]);
    let mut page = view(program.port);
    samples(&mut page, 100);
    page.say(r#"{"unplug":true}"#);
    let lost = status(&mut page, "the loss", |status| status["state"] == "lost");
    assert!(
        lost["message"]
            .as_str()
            .is_some_and(|text| text.contains("plug"))
    );
    page.say(r#"{"send":":help"}"#);
    line(&mut page, "error: not sent: no board is connected");
    page.say(r#"{"unplug":false}"#);
    status(&mut page, "the return", |status| {
        status["state"] == "connected"
    });
    let again = samples(&mut page, 1)[0];
    assert!(again.flags & FIRST != 0, "times begin anew: {again:?}");
}

#[test]
fn where_nothing_is_plugged_in_the_emulated_board_can_be_taken_and_left() {
    let program = Server::view(&["--port", "/dev/no-such-port"]);
    let mut page = view(program.port);
    let waiting = status(&mut page, "nothing", |status| {
        status["message"]
            .as_str()
            .is_some_and(|text| text.contains("/dev/no-such-port is not there"))
    });
    assert_eq!(waiting["state"], "waiting");
    assert_eq!(waiting["kind"], "port");
    assert_eq!(waiting["motions"].as_array().map(Vec::len), Some(0));
    for refused in [
        r#"{"motion":"head"}"#,
        r#"{"unplug":true}"#,
        r#"{"stop":true}"#,
    ] {
        page.say(refused);
        line(&mut page, "error: only the emulated board");
    }
    page.say(r#"{"start":"emulated"}"#);
    status(&mut page, "the emulated board", |status| {
        status["kind"] == "emulated" && status["state"] == "connected"
    });
    samples(&mut page, 100);
    // Twice is once.
    page.say(r#"{"start":"emulated"}"#);
    page.say(r#"{"motion":"turns"}"#);
    status(&mut page, "the other motion", |status| {
        status["motion"] == "turns"
    });
    // The whole board starts again, and so does its time.
    page.find("its new beginning", |message| {
        let first = *batch(message)?.first()?;
        (first.flags & FIRST != 0 && first.time < 2.0).then_some(())
    });
    page.say(r#"{"stop":true}"#);
    let left = status(&mut page, "the port again", |status| {
        status["kind"] == "port"
    });
    assert_eq!(left["state"], "waiting");
}

#[test]
fn an_emulated_board_that_has_ended_is_started_again() {
    let image = place("started-again.elf");
    std::fs::write(&image, "no image").expect("written");
    let name = image.to_str().expect("a path of text");
    let program = Server::view(&["--emulate", "--image", name]);
    let mut page = view(program.port);
    status(&mut page, "its end", |status| status["state"] == "ended");
    let built = firmware::build(BuildOptions { quiet: true }).expect("the firmware builds");
    std::fs::copy(built, &image).expect("copied");
    page.say(r#"{"start":"emulated"}"#);
    status(&mut page, "the board", |status| {
        status["kind"] == "emulated" && status["state"] == "connected"
    });
    samples(&mut page, 100);
}

#[test]
fn two_pages_see_the_same() {
    let program = Server::view(&["--emulate"]);
    let mut pages = [view(program.port), view(program.port)];
    let [first, second] = pages.each_mut().map(|page| {
        status(page, "frames", |status| {
            status["rate"].as_f64() > Some(900.0)
        });
        samples(page, 500)
    });
    let shared: Vec<_> = first
        .iter()
        .filter(|sample| second.contains(sample))
        .collect();
    let begins = first.iter().position(|sample| *sample == second[0]);
    let begins = begins.or_else(|| second.iter().position(|sample| *sample == first[0]));
    assert!(
        begins.is_some() && !shared.is_empty(),
        "they have nothing in common"
    );
    // One that leaves takes nobody with it.
    let [left, mut other] = pages;
    left.hang_up();
    a_while();
    samples(&mut other, 500);
}

#[cfg(unix)]
#[test]
fn it_ends_with_a_good_bye() {
    let program = Server::view(&["--emulate"]);
    let mut page = view(program.port);
    samples(&mut page, 10);
    program.interrupt();
    assert!(page.ends_with_good_bye());
    program.end().expect(0);
}
