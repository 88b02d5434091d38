//! What a host chooses to be streamed, read with the decoder it would use.

#[path = "tracker/bench.rs"]
mod bench;

use bench::{Bench, LEVEL, handled};
use vrduino::sensor::RawSample;
use vrduino::sensor::magnetometer::{RawField, Resolution, SensitivityAdjustment};
use vrduino::wire::PACKET_LEN;
use vrduino::wire::decoder::{Decoder, Event, Losses, Received};
use vrduino::wire::frame::Counts;
use vrduino::wire::provenance::Compass;

/// What came of the lines and frames so far, in their order, and leaves none.
fn read(bench: &mut Bench) -> (Vec<Received>, Vec<Counts>, Losses) {
    let mut decoder = Decoder::new();
    let (mut orientations, mut counts) = (Vec::new(), Vec::new());
    let lines = bench.lines.drain(..);
    let mut sent: Vec<_> = lines.map(|(at, line)| (at, line.into_bytes())).collect();
    sent.append(&mut bench.frames);
    sent.sort_by_key(|&(at, _)| at);
    for (_, bytes) in sent {
        assert!(bytes.len() <= PACKET_LEN || !bytes.starts_with(b"QC"));
        for byte in bytes {
            match decoder.push(byte) {
                Some(Event::Orientation(received)) => orientations.push(received),
                Some(Event::Counts(raw, _)) => counts.push(raw),
                Some(Event::Text(_)) | None => {}
                Some(Event::Unknown(kind)) => panic!("kind {kind}"),
            }
        }
    }
    (orientations, counts, *decoder.losses())
}

#[test]
fn a_timed_line_has_the_next_number_and_the_time_of_its_sample() {
    let mut bench = Bench::started();
    bench.ask(":stream timed");
    bench.lines.clear();
    bench.feed(30, |_| LEVEL);
    assert!(
        bench.lines[0]
            .1
            .starts_with("QC 1.000 0.000 0.000 0.000 0 1010000 *"),
        "{:?}",
        bench.lines
    );
    assert_eq!(
        bench.lines.iter().map(|(at, _)| *at).collect::<Vec<_>>(),
        [1010, 1020, 1030]
    );
    let (orientations, _, losses) = read(&mut bench);
    let stamps = orientations.iter().filter_map(|received| received.stamp);
    let stamps: Vec<_> = stamps.map(|stamp| (stamp.sequence, stamp.micros)).collect();
    assert_eq!(stamps, [(0, 1_010_000), (1, 1_020_000), (2, 1_030_000)]);
    assert_eq!(losses.bytes, 0);
}

#[test]
fn a_frame_comes_with_every_sample_and_lines_between_them() {
    let mut bench = Bench::started();
    bench.ask(":stream binary");
    bench.feed(500, handled);
    bench.ask(":bias");
    bench.feed(500, handled);
    assert_eq!(bench.tagged("QC").len(), 0);
    assert_eq!(bench.tagged("OK bias").len(), 1);
    assert_eq!(bench.frames.len(), 1000);
    assert!(bench.frames.iter().all(|(_, frame)| frame.len() == 29));
    let last = bench.tracker.orientation().cast::<f64>();
    let (orientations, counts, losses) = read(&mut bench);
    assert_eq!((orientations.len(), counts.len()), (1000, 0));
    assert_eq!((losses.bytes, losses.missing, losses.restarts), (0, 0, 0));
    for (n, received) in orientations.iter().enumerate() {
        let stamp = received.stamp.expect("a stamp");
        assert_eq!(usize::from(stamp.sequence), n);
        assert_eq!(stamp.micros as usize, 1000 * (1001 + n));
    }
    assert!(orientations[999].orientation.angle_to(&last) < 1e-7);
    // Fewer of them have numbers in a row all the same.
    bench.ask(":every 7");
    bench.feed(700, handled);
    let (orientations, _, losses) = read(&mut bench);
    assert_eq!((orientations.len(), losses.missing), (100, 0));
}

#[test]
fn counts_are_what_the_sensor_said() {
    let mut bench = Bench::started();
    bench
        .tracker
        .set_magnetometer(Some(SensitivityAdjustment::NONE));
    bench.ask(":stream counts");
    let field = RawField {
        counts: [-267, 200, 133],
        resolution: Resolution::Bits16,
        overflow: false,
    };
    let mut sent = Vec::new();
    for n in 0..100 {
        let sample = handled(n);
        let field = (n % 10 == 3).then_some(field);
        let frame = bench
            .tracker
            .update(&sample, field, &bench.health, &mut |_| {})
            .expect("a frame with every sample");
        bench.frames.push((n, frame.to_vec()));
        sent.push(Counts { sample, field });
    }
    let (orientations, counts, losses) = read(&mut bench);
    assert_eq!(counts, sent);
    assert_eq!((orientations.len(), losses.bytes), (100, 0));
}

#[test]
fn the_status_says_what_was_going_on() {
    let mut bench = Bench::new();
    bench.ask(":stream binary");
    let mut status = |samples: u32, raw: RawSample, line: &str| {
        if !line.is_empty() {
            bench.ask(line);
        }
        bench.feed(samples, |_| raw);
        bench.lines.clear();
        let (orientations, _, _) = read(&mut bench);
        orientations.last().and_then(|received| received.status)
    };
    assert_eq!(status(999, LEVEL, ""), None, "no orientation yet");
    let still = status(3000, LEVEL, "").expect("a status");
    assert!(still.still && still.bias_measured && !still.repeated && !still.clipped);
    assert_eq!((still.notes, still.compass), (false, Compass::Absent));
    let again = RawSample {
        fresh: false,
        ..LEVEL
    };
    assert!(status(1, again, "").unwrap().repeated);
    let hit = RawSample {
        gyro: [i16::MAX, 0, 0],
        ..LEVEL
    };
    let hit = status(1, hit, "").unwrap();
    assert!(hit.clipped && !hit.repeated);
    let turning = RawSample {
        gyro: [0, 3000, 0],
        ..LEVEL
    };
    assert!(!status(1000, turning, "").unwrap().still);
    let notes = status(3000, LEVEL, ":estimator notes").unwrap();
    assert!(notes.notes && !notes.still && notes.bias_measured);
}

#[test]
fn a_board_that_was_never_still_says_that_its_bias_is_a_guess() {
    let mut bench = Bench::new();
    bench.ask(":stream binary");
    bench.feed(6000, handled);
    let (orientations, _, _) = read(&mut bench);
    assert!(orientations.len() > 900);
    assert!(
        orientations
            .iter()
            .all(|received| !received.status.unwrap().bias_measured)
    );
}

#[test]
fn the_compass_is_followed_or_not() {
    let mut bench = Bench::started();
    bench
        .tracker
        .set_magnetometer(Some(SensitivityAdjustment::NONE));
    bench.ask(":stream binary");
    let mut compass = |line: &str, counts: [i16; 3]| {
        bench.ask(line);
        let field = RawField {
            counts,
            resolution: Resolution::Bits16,
            overflow: false,
        };
        let mut last = None;
        for n in 0..5000 {
            let due = (n % 10 == 0).then_some(field);
            last = bench
                .tracker
                .update(&LEVEL, due, &bench.health, &mut |_| {});
        }
        bench.frames.push((0, last.expect("a frame").to_vec()));
        bench.lines.clear();
        let (orientations, _, _) = read(&mut bench);
        orientations[0].status.expect("a status").compass
    };
    let earth = [-267, 200, 133];
    assert_eq!(
        compass(":compass", earth),
        Compass::Unused,
        "not calibrated"
    );
    assert_eq!(compass(":compass on", earth), Compass::Followed);
    assert_eq!(
        compass(":compass on", [-2000, 1500, 900]),
        Compass::Disturbed
    );
    assert_eq!(compass(":compass on", earth), Compass::Followed);
    assert_eq!(compass(":compass off", earth), Compass::Unused);
    assert_eq!(compass(":estimator notes", earth), Compass::Unused);
}

#[test]
fn the_stream_of_the_course_is_the_default_and_what_its_keys_show_goes_on() {
    let mut bench = Bench::started();
    bench.feed(10, |_| LEVEL);
    assert_eq!(bench.texts(), ["QC 1.000 0.000 0.000 0.000\n"]);
    bench.ask(":stream binary");
    bench.lines.clear();
    bench.press(b'2');
    bench.feed(10, |_| LEVEL);
    assert_eq!(
        (bench.tagged("QG").len(), bench.tagged("EA").len()),
        (10, 10)
    );
    assert_eq!(bench.frames.len(), 10);
    bench.press(b'4');
    bench.feed(10, |_| LEVEL);
    assert_eq!((bench.tagged("ACC").len(), bench.frames.len()), (10, 10));
    bench.ask(":defaults");
    bench.lines.clear();
    bench.press(b'5');
    bench.feed(10, |_| LEVEL);
    assert_eq!(bench.texts(), ["QC 1.000 0.000 0.000 0.000\n"]);
}
