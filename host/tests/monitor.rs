//! `vrduino monitor`, as a user starts it.

#![cfg(unix)]

mod program;

mod pty;

use program::Program;
use serde_json::Value;

#[test]
fn the_emulated_board_streams_soundly() {
    let program = Program::start(&["monitor", "--emulate", "--interval", "0.2"]);
    let line = program.until("the bias is measured", |line| {
        line.contains("bias measured")
    });
    assert!(line.starts_with("emulated board: "), "{line}");
    for words in [
        " a second, delay p50 ",
        "missing 0, CRC errors 0, malformed 0, thrown away 0 bytes, restarts 0; ",
    ] {
        assert!(line.contains(words), "no {words} in {line}");
    }
    program.interrupt();
    let ended = program.end();
    let out = &ended.expect(0).out;
    let summary = &out[out.find("\nsamples ").expect("a summary")..];
    assert!(
        summary.contains("verdict     the stream is sound"),
        "{summary}"
    );
}

#[test]
fn what_it_says_for_programs_is_json() {
    let arguments = ["monitor", "--emulate", "--json", "--interval", "0.2"];
    let program = Program::start(&arguments);
    let object = |line: &str| -> Value { serde_json::from_str(line).expect("an object a line") };
    program.until("the board is there", |line| {
        object(line)["event"] == "connected"
    });
    let line = program.until("a thousand samples", |line| {
        object(line)["samples"].as_u64() > Some(1000)
    });
    let stream = object(&line);
    assert_eq!(stream["event"], "stream");
    let rate = stream["rate"].as_f64().expect("a number");
    assert!((900.0..1100.0).contains(&rate), "{stream}");
    assert!(stream["delay"]["p99"].is_number(), "{stream}");
    assert!(stream["status"].is_array(), "{stream}");
    program.interrupt();
    let ended = program.end();
    assert_eq!(ended.code, Some(0), "{ended:?}");
    let summary = object(ended.out.lines().last().expect("a summary"));
    assert_eq!(summary["event"], "summary");
    assert_eq!(summary["sound"], true, "{summary}");
    assert!(summary["samples"].as_u64() > Some(1000), "{summary}");
}

#[test]
fn without_a_board_it_waits_and_says_what_to_do() {
    let arguments = ["monitor", "--port", "no-such-port", "--seconds", "0.5"];
    let ended = Program::start(&arguments).end();
    assert_eq!(ended.code, Some(3), "{ended:?}");
    assert!(
        ended.out.starts_with("waiting: no-such-port is not there"),
        "{ended:?}"
    );
    assert!(ended.err.contains("vrduino list"), "{ended:?}");
}

#[test]
fn a_recording_that_is_not_there_is_not_waited_for() {
    let ended = Program::start(&["monitor", "--replay", "no-such-file.csv"]).end();
    ended.expect(5).said("no-such-file.csv");
}

#[test]
fn a_board_that_sends_no_orientation_is_told_from_none() {
    // It measures its bias for the first second.
    let arguments = ["monitor", "--emulate", "--seconds", "0.05"];
    let ended = Program::start(&arguments).end();
    assert_eq!(ended.code, Some(4), "{ended:?}");
    assert!(ended.err.contains("emulated board sends"), "{ended:?}");
}

#[test]
fn times_that_are_none_are_refused() {
    for [option, value] in [
        ["--seconds", "-1"],
        ["--seconds", "NaN"],
        ["--interval", "0"],
        ["--interval", "soon"],
    ] {
        let ended = Program::start(&["monitor", option, value]).end();
        assert_eq!(ended.code, Some(2), "{ended:?}");
        assert!(ended.err.contains("give a number of seconds"), "{ended:?}");
    }
}

#[test]
fn noise_on_the_cable_is_counted_and_judged() {
    // Among the board's bytes now and then some that nobody sent: they make frames wrong and are in none.
    let mut count = 0_u32;
    let board = pty::PluggedIn::new(move || {
        count += 1;
        if count.is_multiple_of(50) {
            b"\x00\x1Fgarbage\x07\xFF".to_vec()
        } else {
            Vec::new()
        }
    });
    let program = Program::start(&["monitor", "--port", &board.path, "--interval", "0.2"]);
    program.until("noise is counted", |line| {
        let counted = line.split("malformed ").nth(1);
        let count = counted.and_then(|rest| rest.split(',').next()?.parse().ok());
        count > Some(10_u32) && line.contains("bias measured")
    });
    program.interrupt();
    let ended = program.end();
    assert_eq!(ended.code, Some(0), "{ended:?}");
    let summary = ended.out;
    assert!(
        summary.contains("pieces that are no line and no frame"),
        "{summary}"
    );
    assert!(!summary.contains("the stream is sound"), "{summary}");
}

#[test]
fn a_board_that_goes_is_waited_for() {
    let port = pty::Port::new();
    let board = pty::PluggedIn::new(Vec::new);
    port.plug(&board);
    let program = Program::start(&["monitor", "--port", port.path()]);
    program.until("the bias is measured", |line| {
        line.contains("bias measured")
    });
    port.pull(board);
    let line = program.until("it is gone", |line| line.starts_with("lost: "));
    assert!(line.contains("plug the board in again"), "{line}");
    program.interrupt();
    let ended = program.end();
    assert_eq!(ended.code, Some(0), "{ended:?}");
    let said = ended.out;
    assert!(said.contains("verdict     the board is gone"), "{said}");
}

#[test]
fn who_closes_the_pipe_is_told_nothing_more() {
    let mut command = std::process::Command::new("sh");
    let line = format!(
        "{} monitor --emulate --interval 0.1 | head -n 3",
        env!("CARGO_BIN_EXE_vrduino")
    );
    let output = command.args(["-c", &line]).output().expect("a shell");
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(said.lines().count(), 3, "{said}");
    assert!(
        output.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}
