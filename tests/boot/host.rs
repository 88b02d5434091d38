//! The serial port as a PC sees it.

use vrduino_emulator::host::{Outcome, Request};
use vrduino_emulator::motion::Motion;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::time;

use crate::run::{PRINTED, Run, Y, degrees_between};

#[test]
fn a_strict_host_enumerates_the_board_as_a_teensy_and_finds_nothing_to_object_to() {
    let mut run = Run::still();
    run.seconds(2.0);
    let chip = run.board.chip();
    let device = chip.host.identity().expect("the device is configured");
    assert_eq!((device.vendor, device.product), (0x16C0, 0x0483));
    assert_eq!(device.manufacturer, "Teensyduino");
    drop(chip);
    assert_eq!(run.board.stop(), None);
}

#[test]
fn a_host_that_stops_reading_costs_lines_but_no_samples() {
    let motion = || Turns::new(2.5, 0.2).turn(Y, 90.0, 1.0);
    let mut run = Run::moved_by(motion());
    run.seconds(2.0);
    run.board.chip().host.set_reading(false);
    run.seconds(2.0);
    run.board.chip().host.set_reading(true);
    run.seconds(0.3);
    let dropped = run.variable("vrduino_dropped_lines");
    assert!(
        (150..=200).contains(&dropped),
        "{dropped} lines dropped in 2 s"
    );
    // Whole lines, each of a kind that the firmware sends.
    let (whole, _) = run.text.rsplit_once('\n').expect("lines");
    for line in whole.lines() {
        let orientation = line.starts_with("QC ") && line.split(' ').count() == 5;
        let text = ["vrduino ", "Measuring bias", "Bias: "]
            .iter()
            .any(|tag| line.starts_with(tag));
        assert!(orientation || text, "a torn line: {line:?}");
    }
    let expected = motion().at(10.0).truth.unwrap();
    let error = degrees_between(run.last(), expected);
    assert!(
        error < 0.2 + PRINTED,
        "{error}° off: samples were lost with the lines"
    );
}

#[test]
fn the_board_survives_a_bus_reset_a_replug_and_back_to_back_requests() {
    let mut run = Run::still();
    run.seconds(1.5);
    run.board.chip().host.reset_bus();
    run.seconds(0.4);
    assert!(
        run.board.chip().host.is_open(),
        "not enumerated again after a bus reset"
    );
    run.board.chip().host.set_plugged(false);
    run.seconds(0.3);
    run.board.chip().host.set_plugged(true);
    run.seconds(0.5);
    {
        let mut chip = run.board.chip();
        assert!(chip.host.is_open(), "not enumerated again after a replug");
        for _ in 0..5 {
            // One that must be refused between two that must be answered.
            chip.host.request(Request::read(0x80, 6, 0x0100, 0, 18));
            chip.host.request(Request::read(0x80, 6, 0x0600, 0, 10));
            chip.host.request(Request::write(
                0x21,
                0x20,
                0,
                0,
                &[0x80, 0x25, 0, 0, 0, 0, 8],
            ));
            chip.host.request(Request::read(0xA1, 0x21, 0, 0, 7));
        }
    }
    run.seconds(0.2);
    let outcomes = run.board.chip().host.take_outcomes();
    assert_eq!(outcomes.len(), 20);
    for (request, outcome) in &outcomes {
        match (request.setup[1], request.setup[3], outcome) {
            (6, 1, Outcome::Done(descriptor)) => assert_eq!(descriptor.len(), 18),
            (6, 6, Outcome::Stalled) => {}
            (0x20, _, Outcome::Done(_)) => {}
            (0x21, _, Outcome::Done(coding)) => assert_eq!(coding[..4], [0x80, 0x25, 0, 0]),
            _ => panic!("{request:02x?} ended with {outcome:?}"),
        }
    }
    let before = run.orientations.len();
    run.seconds(0.5);
    assert!(
        run.orientations.len() > before + 40,
        "the stream has not gone on"
    );
    assert_eq!(run.board.stop(), None);
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn a_request_at_134_baud_hands_the_board_to_its_loader_with_and_without_a_sensor() {
    for absent in [false, true] {
        let mut run = Run::still();
        run.board.chip().sensor.faults.absent = absent;
        run.seconds(2.5);
        // Any other speed is only remembered.
        run.board.chip().host.set_baud(9600);
        run.seconds(0.1);
        assert_eq!(run.board.in_loader(), None);
        let asked = run.board.now();
        run.board.chip().host.set_baud(134);
        run.seconds(0.1);
        let entered = run.board.in_loader().expect("the loader has the board");
        let took = time::seconds(entered - asked);
        assert!((0.015..0.025).contains(&took), "after {took} s");
        let outcomes = run.board.chip().host.take_outcomes();
        let acknowledged =
            |(_, outcome): &(Request, Outcome)| *outcome == Outcome::Done(Vec::new());
        assert!(
            outcomes.len() == 2 && outcomes.iter().all(acknowledged),
            "{outcomes:?}"
        );
        assert_eq!(run.board.resets(), 0);
    }
}

#[test]
fn bus_resets_at_any_moment_of_the_traffic_leave_nothing_behind() {
    let mut run = Run::still();
    run.seconds(1.2);
    for moment in 0..8 {
        run.seconds(0.05 + 0.001_37 * f64::from(moment));
        run.board.chip().host.reset_bus();
        run.seconds(0.25);
        assert!(run.board.chip().host.is_open(), "after reset {moment}");
        run.forget();
        run.wait_for("QC ", 0.5);
    }
    assert_eq!((run.board.stop(), run.board.resets()), (None, 0));
}

#[test]
fn a_noisy_cable_costs_time_but_no_byte() {
    let mut run = Run::still();
    // Every fourth transaction, from the first request on.
    run.board.chip().host.set_noise(4);
    run.seconds(1.5);
    assert_eq!(run.board.chip().host.identity().unwrap().product, 0x0483);
    run.board.chip().host.send(b"1");
    run.wait_for("FLAT ", 0.5);
    run.seconds(1.0);
    let (whole, _) = run.text.rsplit_once('\n').expect("lines");
    for line in whole.lines() {
        let known = ["QC ", "FLAT ", "vrduino ", "Measuring bias", "Bias: "];
        assert!(known.iter().any(|tag| line.starts_with(tag)), "{line:?}");
    }
    assert_eq!((run.board.stop(), run.board.resets()), (None, 0));
}

#[test]
fn the_board_sleeps_with_the_bus_and_streams_again_when_it_is_resumed() {
    let mut run = Run::still();
    run.seconds(1.5);
    for _ in 0..2 {
        run.board.chip().host.set_suspended(true);
        run.seconds(0.3);
        let asleep = run.orientations.len();
        run.seconds(0.2);
        assert_eq!(run.orientations.len(), asleep);
        run.board.chip().host.set_suspended(false);
        run.seconds(0.3);
        assert!(run.orientations.len() > asleep + 20, "it does not go on");
    }
    assert_eq!((run.board.stop(), run.board.resets()), (None, 0));
}

#[test]
fn keys_choose_what_is_streamed() {
    let mut run = Run::still();
    run.seconds(1.5);
    for (key, tag) in [
        ("1", "FLAT "),
        ("2", "EA "),
        ("3", "GYR: "),
        ("4", "ACC: "),
        ("0", "nReads/sec: "),
    ] {
        run.forget();
        run.board.chip().host.send(key.as_bytes());
        run.wait_for(tag, 1.5);
    }
    run.forget();
    run.board.chip().host.send(b"b5");
    run.wait_for("Measuring bias", 0.5);
    run.wait_for("(still)", 2.0);
    run.wait_for("QC ", 0.5);
}

#[test]
fn reset_brings_the_heading_back_to_zero_and_keeps_the_tilt() {
    let motion = Turns::new(2.0, 5.0).turn(Y, 60.0, 0.5);
    let mut run = Run::moved_by(motion);
    run.seconds(3.0);
    assert!(degrees_between(run.last(), [1.0, 0.0, 0.0, 0.0]) > 55.0);
    run.board.chip().host.send(b"r");
    run.seconds(0.1);
    assert!(degrees_between(run.last(), [1.0, 0.0, 0.0, 0.0]) < 0.5);
}

#[test]
fn a_terminal_that_echoes_the_stream_presses_no_keys() {
    let mut run = Run::still();
    let mut echoed = 0;
    for _ in 0..300 {
        run.seconds(0.01);
        let echo = run.text.as_bytes()[echoed..].to_vec();
        echoed = run.text.len();
        run.board.chip().host.send(&echo);
    }
    let known = ["QC ", "vrduino ", "Measuring bias", "Bias: "];
    let (whole, _) = run.text.rsplit_once('\n').expect("lines");
    for line in whole.lines() {
        assert!(known.iter().any(|tag| line.starts_with(tag)), "{line:?}");
    }
    assert!(run.orientations.len() > 100);
    assert_eq!(run.text.matches("Measuring bias").count(), 1);
}

#[test]
fn whatever_is_typed_at_once_is_all_answered() {
    let mut run = Run::still();
    run.seconds(1.5);
    let lines: String = (0..40).map(|i| format!(":every {}\n", 10 + i)).collect();
    run.board.chip().host.send(lines.as_bytes());
    run.seconds(1.0);
    for i in 0..40 {
        let answer = format!("OK stream text every {}\n", 10 + i);
        assert!(run.text.contains(&answer), "no {answer:?}");
    }
    assert!(!run.text.contains("ERR"));
}
