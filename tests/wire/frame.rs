//! Frames, to the byte.

use super::random::Random;
use vrduino::sensor::RawSample;
use vrduino::sensor::magnetometer::{RawField, Resolution};
use vrduino::wire::cobs::{LONGEST, TooLong, stuff, unstuff};
use vrduino::wire::frame::{self, Counts, Damage, Message};
use vrduino::wire::provenance::Compass;
use vrduino::wire::{self, Decimals, PACKET_LEN, Provenance, Q30, Stamp, Status, Tag};

const QUARTER: Q30 = Q30([759_250_125, 0, 759_250_125, 0]);

fn provenance(status: u8, sequence: u16, micros: u32) -> Provenance {
    Provenance {
        stamp: Stamp { sequence, micros },
        status: Status::from_byte(status),
    }
}

fn bytes(hexadecimal: &str) -> Vec<u8> {
    let digits = hexadecimal.split(' ');
    digits
        .map(|byte| u8::from_str_radix(byte, 16).expect("a byte"))
        .collect()
}

#[test]
fn an_orientation_is_these_bytes() {
    for (q, status, sequence, micros, expected) in [
        (
            Q30::IDENTITY,
            0,
            0,
            0,
            "00 02 01 01 01 01 01 01 01 01 01 01 02 40 01 01 01 01 01 01 01 01 01 01 01 03 59 82 00",
        ),
        (
            QUARTER,
            0x50,
            7,
            1_234_567,
            "00 04 01 50 07 04 87 d6 12 05 cd 3c 41 2d 01 01 01 05 cd 3c 41 2d 01 01 01 03 7c eb 00",
        ),
        (
            Q30([123_456_789, -987_654_321, 1, -1]),
            0x55,
            0x0102,
            0x0304_0506,
            "00 12 01 55 02 01 06 05 04 03 15 cd 5b 07 4f 97 21 c5 01 01 01 07 ff ff ff ff 52 2e 00",
        ),
        (
            Q30([i32::MAX; 4]),
            0x55,
            0x0102,
            0x0304_0506,
            "00 1b 01 55 02 01 06 05 04 03 ff ff ff 7f ff ff ff 7f ff ff ff 7f ff ff ff 7f 47 95 00",
        ),
    ] {
        let provenance = provenance(status, sequence, micros);
        let frame = frame::orientation(q, provenance);
        assert_eq!(frame.as_slice(), bytes(expected));
        let message = frame::parse(&frame[1..frame.len() - 1]);
        assert_eq!(message, Ok(Message::Orientation(q, provenance)));
    }
}

#[test]
fn counts_follow_in_the_same_packet() {
    let provenance = provenance(0x50, 7, 1_234_567);
    let sample = RawSample {
        gyro: [13, -8, 5],
        accel: [0, 2048, -1],
        temperature: -4321,
        fresh: true,
    };
    let counts = Counts {
        sample,
        field: None,
    };
    let both = frame::orientation_and_counts(QUARTER, provenance, &counts);
    let (first, second) = both.split_at(29);
    assert_eq!(first, frame::orientation(QUARTER, provenance));
    let expected =
        "00 04 02 50 07 04 87 d6 12 02 0d 04 f8 ff 05 01 01 01 08 08 ff ff 1f ef 42 63 00";
    assert_eq!(second, bytes(expected));
    let message = frame::parse(&second[1..second.len() - 1]);
    assert_eq!(message, Ok(Message::Counts(counts, provenance.stamp)));
}

#[test]
fn a_field_follows_them_and_all_of_it_is_still_one_packet() {
    let provenance = provenance(0x51, 7, 1_234_567);
    let sample = RawSample {
        gyro: [i16::MAX, i16::MIN, 5],
        accel: [0, 2048, -1],
        temperature: -4321,
        fresh: false,
    };
    let field = RawField {
        counts: [-267, 200, 133],
        resolution: Resolution::Bits16,
        overflow: false,
    };
    let counts = Counts {
        sample,
        field: Some(field),
    };
    let both = frame::orientation_and_counts(QUARTER, provenance, &counts);
    assert_eq!(both.len(), 62);
    assert!(both.len() <= PACKET_LEN);
    let second = &both[29..];
    let expected = "00 04 03 51 07 04 87 d6 12 03 ff 7f 03 80 05 01 01 01 09 08 ff ff 1f ef \
                    f5 fe c8 02 85 03 69 7a 00";
    assert_eq!(second, bytes(expected));
    let message = frame::parse(&second[1..second.len() - 1]);
    assert_eq!(message, Ok(Message::Counts(counts, provenance.stamp)));
    // One that means nothing is not sent.
    for field in [
        RawField {
            overflow: true,
            ..field
        },
        RawField {
            resolution: Resolution::Bits14,
            ..field
        },
    ] {
        let counts = Counts {
            sample,
            field: Some(field),
        };
        let without = Counts {
            sample,
            field: None,
        };
        assert_eq!(
            frame::orientation_and_counts(QUARTER, provenance, &counts),
            frame::orientation_and_counts(QUARTER, provenance, &without)
        );
    }
}

#[test]
fn every_status_is_its_bits() {
    let none = Status::default();
    for (status, byte) in [
        (none, 0),
        (
            Status {
                repeated: true,
                ..none
            },
            0x01,
        ),
        (
            Status {
                clipped: true,
                ..none
            },
            0x02,
        ),
        (
            Status {
                still: true,
                ..none
            },
            0x04,
        ),
        (
            Status {
                compass: Compass::Unused,
                ..none
            },
            0x08,
        ),
        (
            Status {
                compass: Compass::Followed,
                ..none
            },
            0x10,
        ),
        (
            Status {
                compass: Compass::Disturbed,
                ..none
            },
            0x18,
        ),
        (
            Status {
                notes: true,
                ..none
            },
            0x20,
        ),
        (
            Status {
                bias_measured: true,
                ..none
            },
            0x40,
        ),
        (
            Status {
                skipped: true,
                ..none
            },
            0x80,
        ),
    ] {
        assert_eq!(status.to_byte(), byte);
        assert_eq!(Status::from_byte(byte), status);
    }
    for byte in 0..=u8::MAX {
        assert_eq!(Status::from_byte(byte).to_byte(), byte);
    }
}

#[test]
fn a_frame_of_a_newer_board_is_whole_and_unknown() {
    let unknown = bytes("02 7f 02 01 02 02 01 01 06 6e 65 77 ab 15");
    assert_eq!(frame::parse(&unknown), Ok(Message::Unknown(0x7F)));
    let mut wrong = unknown;
    wrong[10] ^= 0x20;
    assert_eq!(frame::parse(&wrong), Err(Damage::Checksum));
    for malformed in [
        "",
        "01",
        "02 01",
        "05 01 02",
        "01 01 01 01 01 01 01 01 01 01",
    ] {
        let damage = match malformed {
            "" => frame::parse(&[]),
            other => frame::parse(&bytes(other)),
        };
        assert!(damage.is_err(), "{malformed}");
    }
}

#[test]
fn stuffed_bytes_have_no_zero_and_come_back() {
    for (message, stuffed) in [
        ("00", "01 01"),
        ("00 00", "01 01 01"),
        ("11 22 00 33", "03 11 22 02 33"),
        ("11 22 33 44", "05 11 22 33 44"),
        ("11 00 00 00", "02 11 01 01 01"),
    ] {
        let mut out = [vec![0xAA], bytes(message)].concat();
        stuff(&mut out).expect("it is short");
        assert_eq!(out, bytes(stuffed));
    }
    let mut random = Random(6);
    for round in 0..100_000 {
        let length = round % LONGEST;
        let zeros = random.unit();
        let mut byte = || match random.unit() < zeros {
            true => 0,
            false => random.between(0.0, 256.0) as u8,
        };
        let message: Vec<u8> = (0..length).map(|_| byte()).collect();
        let mut out = [vec![0], message.clone()].concat();
        stuff(&mut out).expect("it is short");
        assert!(!out.contains(&0));
        assert_eq!(unstuff(&mut out), Some(message.as_slice()));
    }
    let mut long = [7; LONGEST + 1];
    assert_eq!(stuff(&mut long), Err(TooLong));
    assert_eq!(long, [7; LONGEST + 1], "as they were");
    assert_eq!(unstuff(&mut [0; 0]), None);
    assert_eq!(unstuff(&mut [1]), Some([].as_slice()));
    assert_eq!(unstuff(&mut [3, 1]), None, "cut short");
    assert_eq!(unstuff(&mut [3, 1, 2, 0]), None, "a zero");
    assert_eq!(unstuff(&mut [3, 0, 1]), None, "a zero");
    assert_eq!(unstuff(&mut [2, 9, 0]), None, "a zero");
    assert_eq!(unstuff(&mut [255; 255]), Some([255; 254].as_slice()));
}

/// The examples of the specification are what is sent.
#[test]
fn the_document_says_so() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/wire-format.md");
    let text = std::fs::read_to_string(path).expect("the document");
    let after = |start: &str| {
        let mut lines = text.lines();
        lines
            .find_map(|line| line.strip_prefix(start))
            .expect("the example")
    };
    let provenance = provenance(0x50, 7, 1_234_567);
    let frame = frame::orientation(QUARTER, provenance);
    assert_eq!(frame.as_slice(), bytes(after("sent  ")), "{frame:x?}");
    let mut message = bytes(after("message  "));
    message.insert(0, 0);
    stuff(&mut message).expect("it is short");
    assert_eq!(message, frame[1..frame.len() - 1]);
    for line in [
        wire::timed(QUARTER, provenance.stamp, Decimals::COURSE),
        wire::quaternion(Tag::Fused, QUARTER, Decimals::COURSE),
    ] {
        assert!(text.contains(&format!("```text\n{line}```")), "{line}");
    }
}
