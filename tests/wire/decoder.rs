//! The stream read again, whole and damaged.

use super::random::Random;
use vrduino::sensor::RawSample;
use vrduino::wire::decoder::{Decoder, Event, Losses, Received};
use vrduino::wire::frame::{self, Counts};
use vrduino::wire::{self, Decimals, LINE_LEN, Provenance, Q30, Stamp, Status, Tag};

/// Events, with what they borrow.
#[derive(Clone, Debug, PartialEq)]
enum Came {
    Orientation(Received),
    Counts(Counts, Stamp),
    Text(String),
    Unknown(u8),
}

fn push(decoder: &mut Decoder, bytes: &[u8]) -> Vec<Came> {
    let mut came = Vec::new();
    for &byte in bytes {
        came.extend(decoder.push(byte).map(|event| match event {
            Event::Orientation(received) => Came::Orientation(received),
            Event::Counts(counts, stamp) => Came::Counts(counts, stamp),
            Event::Text(text) => Came::Text(text.to_owned()),
            Event::Unknown(kind) => Came::Unknown(kind),
        }));
    }
    came
}

fn decode(bytes: &[u8]) -> (Vec<Came>, Losses) {
    let mut decoder = Decoder::new();
    let came = push(&mut decoder, bytes);
    (came, *decoder.losses())
}

fn random_rotation(random: &mut Random) -> Q30 {
    let q = [(); 4].map(|()| random.between(-1.0, 1.0));
    let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    Q30(q.map(|c| (c / norm * f64::from(1 << 30)) as i32))
}

fn provenance(sequence: u16, random: &mut Random) -> Provenance {
    Provenance {
        stamp: Stamp {
            sequence,
            micros: random.between(0.0, 4_294_967_296.0) as u32,
        },
        status: Status::from_byte(random.between(0.0, 128.0) as u8),
    }
}

fn byte(random: &mut Random) -> u8 {
    random.between(0.0, 256.0) as u8
}

/// Any bytes, those that mean something to the decoder more often than by chance.
fn garbage(length: usize, random: &mut Random) -> Vec<u8> {
    let any = |random: &mut Random| match random.unit() {
        ..0.1 => 0,
        ..0.15 => b'\n',
        ..0.3 => random.between(0.0, 32.0) as u8,
        ..0.6 => b"QC -0.123456789*AF"[random.between(0.0, 18.0) as usize],
        _ => byte(random),
    };
    (0..length).map(|_| any(random)).collect()
}

/// Something of every kind, and what is to come of it.
fn sent(kind: u32, sequence: u16, random: &mut Random) -> (Vec<u8>, Vec<Came>) {
    let q = random_rotation(random);
    let from = provenance(sequence, random);
    let rotation = |components: [f64; 4], stamp, status| {
        let [w, x, y, z] = components;
        let q = nalgebra::Quaternion::new(w, x, y, z);
        Came::Orientation(Received {
            orientation: nalgebra::UnitQuaternion::new_normalize(q),
            components,
            stamp,
            status,
        })
    };
    let decimals = Decimals::new(3 + kind % 3).expect("3 to 5");
    let one = 10_f64.powi(decimals.get() as i32);
    let printed = q.components().map(|c| (c * one).round() / one);
    let framed = rotation(q.components(), Some(from.stamp), Some(from.status));
    match kind % 5 {
        0 => {
            let line = wire::quaternion(Tag::Fused, q, decimals);
            (
                line.as_bytes().to_vec(),
                vec![rotation(printed, None, None)],
            )
        }
        1 => {
            let line = wire::timed(q, from.stamp, decimals);
            let stamp = Some(from.stamp);
            (
                line.as_bytes().to_vec(),
                vec![rotation(printed, stamp, None)],
            )
        }
        2 => (frame::orientation(q, from).to_vec(), vec![framed]),
        3 => {
            let sample = RawSample {
                gyro: [(); 3].map(|()| random.between(-32768.0, 32768.0) as i16),
                accel: [(); 3].map(|()| random.between(-32768.0, 32768.0) as i16),
                temperature: 0,
                fresh: !from.status.repeated,
            };
            let counts = Counts {
                sample,
                field: None,
            };
            let bytes = frame::orientation_and_counts(q, from, &counts).to_vec();
            (bytes, vec![framed, Came::Counts(counts, from.stamp)])
        }
        _ => {
            let text = format!("OK bias {sequence} deg/s, still 7 °");
            (
                wire::text(&text).as_bytes().to_vec(),
                vec![Came::Text(text)],
            )
        }
    }
}

#[test]
fn whatever_is_sent_comes_out_in_its_order() {
    let mut random = Random(11);
    let (mut bytes, mut expected) = (Vec::new(), Vec::new());
    let mut sequence = 65_000_u16;
    for round in 0..50_000 {
        // The course's line comes by itself, at the start.
        let kind = match round {
            ..10_000 => 5 * random.between(0.0, 3.0) as u32,
            _ => random.between(1.0, 5.0) as u32,
        };
        let (more, came) = sent(kind, sequence, &mut random);
        if came
            .iter()
            .any(|came| matches!(came, Came::Orientation(r) if r.stamp.is_some()))
        {
            sequence = sequence.wrapping_add(1);
        }
        bytes.extend(more);
        expected.extend(came);
    }
    let (came, losses) = decode(&bytes);
    assert_eq!(came.len(), expected.len());
    for (came, expected) in came.iter().zip(&expected) {
        match (came, expected) {
            (Came::Orientation(came), Came::Orientation(expected)) => {
                assert_eq!((came.stamp, came.status), (expected.stamp, expected.status));
                let off = came.orientation.angle_to(&expected.orientation);
                assert!(off < 1e-7, "{came:?} instead of {expected:?}");
                assert!((came.orientation.norm() - 1.0).abs() < 1e-15);
                for (c, e) in came.components.iter().zip(expected.components) {
                    assert!((c - e).abs() < 1e-12, "{came:?} instead of {expected:?}");
                }
            }
            _ => assert_eq!(came, expected),
        }
    }
    assert_eq!((losses.bytes, losses.missing, losses.restarts), (0, 0, 0));
    // Ends of lines as other systems have them.
    let (came, losses) = decode(b"QC 1.000 0.000 0.000 0.000\r\n\r\n\nhello\r\n");
    assert_eq!((came.len(), losses.bytes), (2, 0));
    assert_eq!(came[1], Came::Text("hello".into()));
}

#[test]
fn four_million_random_bytes_are_counted_and_make_no_orientation() {
    let mut random = Random(12);
    for plain in [true, false] {
        let bytes = match plain {
            true => (0..2_000_000).map(|_| byte(&mut random)).collect(),
            false => garbage(2_000_000, &mut random),
        };
        let (came, losses) = decode(&[bytes.as_slice(), b"\0"].concat());
        let mut text = 0;
        for came in &came {
            match came {
                Came::Text(line) => text += line.len() as u64,
                other => panic!("{other:?}"),
            }
        }
        let ends = |byte| matches!(byte, 0 | b'\n' | b'\r');
        let ends = bytes.iter().filter(|&&byte| ends(byte)).count() as u64;
        let accounted = losses.bytes + text;
        let total = bytes.len() as u64;
        assert!(
            (total - ends..=total).contains(&accounted),
            "{losses:?}, {text} of text"
        );
    }
}

#[test]
fn after_any_garbage_the_next_frame_and_the_third_line_are_there() {
    let mut random = Random(13);
    for round in 0..100_000 {
        let length = random.between(0.0, 200.0) as usize;
        let mut decoder = Decoder::new();
        push(&mut decoder, &garbage(length, &mut random));
        if round % 2 == 0 {
            let (bytes, expected) = sent(2, 5, &mut random);
            assert_eq!(push(&mut decoder, &bytes).len(), expected.len());
            continue;
        }
        let came: Vec<usize> = (0..3)
            .map(|_| {
                let (bytes, _) = sent(1, 5, &mut random);
                let came = push(&mut decoder, &bytes);
                let orientation = |came: &&Came| matches!(came, Came::Orientation(_));
                came.iter().filter(orientation).count()
            })
            .collect();
        assert_eq!(came[2], 1, "{came:?}");
    }
}

#[test]
fn no_one_or_two_wrong_bits_make_another_orientation() {
    let mut random = Random(14);
    for kind in [1, 2, 1, 2] {
        let (before, _) = sent(kind, 8, &mut random);
        let (bytes, right) = sent(kind, 9, &mut random);
        let mut ready = Decoder::new();
        push(&mut ready, &before);
        let bits = 8 * bytes.len();
        let mut accepted = 0;
        for first in 0..bits {
            for second in first..bits {
                let mut wrong = bytes.clone();
                wrong[first / 8] ^= 1 << (first % 8);
                if second > first {
                    wrong[second / 8] ^= 1 << (second % 8);
                }
                wrong.extend(b"\n\0\n");
                for came in push(&mut ready.clone(), &wrong) {
                    match came {
                        Came::Orientation(_) if came == right[0] => {}
                        Came::Orientation(_) => accepted += 1,
                        Came::Counts(..) | Came::Unknown(_) => panic!("{came:?}"),
                        Came::Text(_) => {}
                    }
                }
            }
        }
        assert_eq!(accepted, 0, "kind {kind}");
    }
}

#[test]
fn damaged_streams_give_what_was_sent_or_nothing() {
    let mut random = Random(15);
    let mut decoder = Decoder::new();
    // By sequence number, for a frame that has lost its end comes with the next.
    let mut all = vec![None; 1 << 16];
    let (rounds, mut kept) = (300_000_u32, 0);
    for round in 0..rounds {
        let (mut bytes, expected) = sent(1 + round % 2, round as u16, &mut random);
        let at = random.between(0.0, bytes.len() as f64) as usize;
        match random.unit() {
            ..0.5 => {}
            _ if round == 0 || round + 2 >= rounds => {}
            ..0.6 => bytes.truncate(at),
            ..0.7 => drop(bytes.drain(..at)),
            ..0.8 => drop(bytes.remove(at)),
            ..0.9 => bytes.insert(at, byte(&mut random)),
            _ => bytes[at] = byte(&mut random),
        }
        let Came::Orientation(sent) = expected[0] else {
            panic!("an orientation was sent");
        };
        all[usize::from(round as u16)] = Some(sent);
        for came in push(&mut decoder, &bytes) {
            // A line that has lost its beginning comes as text.
            if let Came::Orientation(came) = came {
                let sequence = came.stamp.expect("a stamp").sequence;
                let sent = all[usize::from(sequence)].take().expect("sent, and once");
                assert_eq!(came.stamp, sent.stamp);
                assert!(came.orientation.angle_to(&sent.orientation) < 1e-6);
                kept += 1;
            }
        }
    }
    let lost = rounds - kept;
    let losses = *decoder.losses();
    assert_eq!((losses.missing, losses.restarts), (lost, 0), "{losses:?}");
    // Half of them were damaged, and some of their neighbours go with them.
    assert!(kept > 140_000 && lost > 100_000, "{kept} kept, {lost} lost");
    assert!(
        losses.damaged > 10_000 && losses.malformed > 10_000,
        "{losses:?}"
    );
}

#[test]
fn a_plain_line_behind_one_with_a_stamp_is_believed_the_second_time() {
    let plain = b"QC 1.000 0.000 0.000 0.000\n";
    let mut decoder = Decoder::new();
    assert_eq!(push(&mut decoder, plain).len(), 1);
    push(&mut decoder, &sent(1, 0, &mut Random(17)).0);
    assert_eq!(push(&mut decoder, plain).len(), 0);
    assert_eq!(
        (decoder.losses().malformed, decoder.losses().bytes),
        (1, 26)
    );
    assert_eq!(push(&mut decoder, plain).len(), 1);
}

#[test]
fn what_is_missing_is_counted_over_the_wrap_and_a_restart_is_none() {
    let mut random = Random(16);
    let mut decoder = Decoder::new();
    for (sequence, missing, restarts) in [
        (65_533, 0, 0),
        (65_535, 1, 0),
        (0, 1, 0),
        (1, 1, 0),
        (5, 4, 0),
        (5, 4, 1),
        (3, 4, 2),
        (4, 4, 2),
        (32_771, 32_770, 2),
        (3, 32_770, 3),
    ] {
        let kind = if sequence % 2 == 0 { 1 } else { 2 };
        let (bytes, _) = sent(kind, sequence, &mut random);
        push(&mut decoder, &bytes);
        let losses = decoder.losses();
        assert_eq!(
            (losses.missing, losses.restarts),
            (missing, restarts),
            "{sequence}"
        );
    }
}

#[test]
fn what_claims_to_be_an_orientation_and_is_none_is_thrown_away() {
    for (line, damaged) in [
        ("QC 0.000 0.000 0.000 0.000", 0),
        ("QC 1.000 0.500 0.000 0.000", 0),
        ("QC 1.000 0.000 0.000", 0),
        ("QC 1.000 0.000 0.000 0.000 7", 0),
        ("QC 1.000 0.000 0.000 0.000 7 8", 0),
        ("QC 1.000  0.000 0.000 0.000", 0),
        ("QC 1.000\t0.000 0.000 0.000", 0),
        ("QC nan 0.000 0.000 0.000", 0),
        ("QC inf 0.000 0.000 0.000", 0),
        ("QC 1e0 0.000 0.000 0.000", 0),
        ("QC 1.000 0.000 0.000 0.000 0 0 *8d00", 0),
        ("QC 1.000 0.000 0.000 0.000 0 0 *8D0", 0),
        ("QC 1.000 0.000 0.000 0.000 0 0*8D00", 1),
        ("QC 1.000 0.000 0.000 0.000 0 1 *8D00", 1),
        ("QC 1.000 0.000 0.000 0.000 0 0 *8D01", 1),
    ] {
        let (came, losses) = decode(format!("{line}\n").as_bytes());
        assert_eq!(came, [], "{line}");
        let counted = (losses.bytes, losses.damaged, losses.malformed);
        assert_eq!(counted, (line.len() as u64, damaged, 1 - damaged), "{line}");
    }
    let frame = frame::orientation(Q30([1 << 30, 1 << 30, 0, 0]), Provenance::default());
    let (came, losses) = decode(&frame);
    assert_eq!((came.len(), losses.malformed, losses.bytes), (0, 1, 27));
    // No line is as long, and what is no text is none.
    let long = "x".repeat(LINE_LEN + 40);
    let (came, losses) = decode(format!("{long}\nhello\n").as_bytes());
    assert_eq!(came, [Came::Text("hello".into())]);
    assert_eq!((losses.bytes, losses.malformed), (LINE_LEN as u64 + 40, 1));
    let (came, losses) = decode(b"hel\x07lo\nhel\xFFlo\nhello\n");
    assert_eq!(came, [Came::Text("hello".into())]);
    assert_eq!((losses.bytes, losses.malformed), (12, 2));
}
