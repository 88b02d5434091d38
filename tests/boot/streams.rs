//! The stream with its provenance, as lines and as frames, read with the decoder a host would use.

use vrduino::sensor::RawSample;
use vrduino::sensor::magnetometer::RawField;
use vrduino::wire::decoder::{Decoder, Event, Losses, Received};
use vrduino::wire::frame::Counts;
use vrduino_emulator::board::Setup;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::motion::{self, Motion};
use vrduino_emulator::time::{self, MILLISECOND};

use crate::run::{Run, Y, degrees_between};

/// What a host has read.
#[derive(Default)]
struct Host {
    decoder: Decoder,
    orientations: Vec<Received>,
    counts: Vec<Counts>,
    text: Vec<String>,
}

impl Host {
    /// Runs the board; whatever it sends is decoded.
    fn read(&mut self, run: &mut Run, seconds: f64) {
        let until = run.board.now() + time::ticks(seconds);
        while run.board.now() < until {
            run.board.run(MILLISECOND);
            assert_eq!(run.board.stop(), None);
            for byte in run.board.chip_quietly().host.take_received() {
                match self.decoder.push(byte) {
                    Some(Event::Orientation(received)) => self.orientations.push(received),
                    Some(Event::Counts(counts, _)) => self.counts.push(counts),
                    Some(Event::Text(line)) => self.text.push(line.to_owned()),
                    Some(Event::Unknown(kind)) => panic!("kind {kind}"),
                    None => {}
                }
            }
        }
    }

    /// Those from `first` on: one number and `micros` after the other.
    fn assert_in_a_row(&self, first: usize, micros: u32) {
        let stamps = self.orientations[first..].iter();
        let stamps: Vec<_> = stamps
            .map(|received| received.stamp.expect("a stamp"))
            .collect();
        for pair in stamps.windows(2) {
            assert_eq!(pair[1].sequence, pair[0].sequence.wrapping_add(1));
            assert_eq!(pair[1].micros.wrapping_sub(pair[0].micros), micros);
        }
    }
}

fn thrown_away(losses: &Losses) -> (u64, u32, u32) {
    (losses.bytes, losses.damaged, losses.malformed)
}

#[test]
fn a_frame_comes_with_every_sample_and_answers_between_them() {
    let motion = || Turns::new(2.0, 0.2).turn(Y, 90.0, 1.0);
    let mut run = Run::moved_by(motion());
    let mut host = Host::default();
    host.read(&mut run, 1.5);
    let before = host.orientations.len();
    assert!(
        host.orientations
            .iter()
            .all(|received| received.stamp.is_none())
    );
    run.board.chip().host.send(b":stream binary\n:version\n");
    host.read(&mut run, 1.7);
    let frames = host.orientations.len() - before;
    assert!((1690..=1702).contains(&frames), "{frames} frames in 1.7 s");
    host.assert_in_a_row(before, 1000);
    assert!(
        host.text
            .iter()
            .any(|line| line == "OK stream binary every 1")
    );
    assert!(host.text.iter().any(|line| line.starts_with("OK vrduino")));
    assert_eq!(thrown_away(host.decoder.losses()), (0, 0, 0));
    assert_eq!(run.variable("vrduino_dropped_lines"), 0);
    let [w, x, y, z] = host.orientations.last().expect("frames").components;
    let expected = motion().at(10.0).truth.expect("a truth");
    let error = degrees_between([w, x, y, z], expected);
    assert!(error < 0.2, "{error}°");
    let status = host.orientations[before].status.expect("a frame's status");
    assert!(status.bias_measured && !status.notes && !status.clipped);
}

#[test]
fn a_line_with_its_provenance_is_whole_and_in_a_row() {
    let mut run = Run::still();
    let mut host = Host::default();
    host.read(&mut run, 1.5);
    let before = host.orientations.len();
    run.board.chip().host.send(b":decimals 6\n:stream timed\n");
    host.read(&mut run, 0.5);
    run.board.chip().host.send(b":every 1\n");
    host.read(&mut run, 0.01);
    let slow = host.orientations.len();
    host.read(&mut run, 0.5);
    assert!(
        (50..=62).contains(&(slow - before)),
        "{} lines",
        slow - before
    );
    assert!((495..=501).contains(&(host.orientations.len() - slow)));
    host.assert_in_a_row(slow, 1000);
    assert_eq!(thrown_away(host.decoder.losses()), (0, 0, 0));
    assert_eq!(run.variable("vrduino_dropped_lines"), 0);
}

#[test]
fn counts_are_those_that_the_sensor_sent() {
    let mut run = Run::with(Setup::new(motion::built_in()));
    let mut host = Host::default();
    host.read(&mut run, 1.5);
    run.board.chip().host.send(b":stream counts\n");
    host.read(&mut run, 0.01);
    host.counts.clear();
    run.board.chip().sensor.recording = Some(Vec::new());
    host.read(&mut run, 1.0);
    let bursts = run
        .board
        .chip()
        .sensor
        .recording
        .take()
        .expect("recording is on");
    let sent: Vec<_> = bursts
        .iter()
        .map(|burst| RawSample::from_burst(&burst.bytes))
        .collect();
    let came: Vec<_> = host.counts.iter().map(|counts| counts.sample).collect();
    // Where the recording begins among what came; one or two more were on their way.
    let start = came
        .windows(3)
        .position(|three| three == &sent[..3])
        .expect("the first three");
    let compared = came.len() - start;
    assert!(start <= 2 && compared > 980, "{compared} from {start} on");
    assert_eq!(came[start..], sent[..compared]);
    let fields = bursts.iter().filter_map(|burst| burst.field.as_ref());
    let sent: Vec<_> = fields
        .filter_map(|bytes| bytes.last_chunk().map(RawField::from_burst))
        .collect();
    let came: Vec<_> = host.counts[start + 2..]
        .iter()
        .filter_map(|counts| counts.field)
        .collect();
    assert!(came.len() > 90, "{} fields", came.len());
    assert!(
        sent.windows(came.len()).any(|sent| sent == came),
        "{sent:?} {came:?}"
    );
    assert_eq!(thrown_away(host.decoder.losses()), (0, 0, 0));
}

#[test]
fn frames_that_a_host_did_not_read_are_missing_and_no_more() {
    let mut run = Run::still();
    let mut host = Host::default();
    host.read(&mut run, 1.5);
    run.board.chip().host.send(b":stream binary\n");
    host.read(&mut run, 0.1);
    run.board.chip().host.set_reading(false);
    host.read(&mut run, 0.5);
    run.board.chip().host.set_reading(true);
    host.read(&mut run, 0.1);
    let dropped = run.variable("vrduino_dropped_lines");
    assert!(
        (450..=500).contains(&dropped),
        "{dropped} dropped in half a second"
    );
    let losses = host.decoder.losses();
    assert_eq!((losses.missing, losses.restarts), (dropped, 0));
    assert_eq!(thrown_away(losses), (0, 0, 0));
}
