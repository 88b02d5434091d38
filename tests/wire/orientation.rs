//! The quaternion's lines, to the byte. The checksums, and the frames of `frame.rs`, were computed from
//! `docs/wire-format.md` by a program that shares nothing with the library.

use super::random::Random;
use nalgebra::{Quaternion, UnitQuaternion};
use vrduino::decimal::Decimal;
use vrduino::wire::crc::crc16;
use vrduino::wire::{self, Decimals, PACKET_LEN, Q30, Stamp, Tag};

const LATE: Stamp = Stamp {
    sequence: u16::MAX,
    micros: u32::MAX,
};
/// A quarter turn to the left: 1/√2 to the nearest bit.
const QUARTER: Q30 = Q30([759_250_125, 0, 759_250_125, 0]);

fn decimals(number: u32) -> Decimals {
    Decimals::new(number).expect("3 to 6")
}

fn line(q: [i32; 4], number: u32) -> String {
    wire::quaternion(Tag::Fused, Q30(q), decimals(number)).to_string()
}

#[test]
fn lines_with_their_provenance_are_these_bytes() {
    let start = Stamp::default();
    assert_eq!(
        wire::timed(Q30::IDENTITY, start, Decimals::COURSE),
        "QC 1.000 0.000 0.000 0.000 0 0 *8D00\n"
    );
    let stamp = Stamp {
        sequence: 7,
        micros: 1_234_567,
    };
    assert_eq!(
        wire::timed(QUARTER, stamp, Decimals::COURSE),
        "QC 0.707 0.000 0.707 0.000 7 1234567 *E8D8\n"
    );
    let some = Q30([123_456_789, -987_654_321, 1, -1]);
    for (number, expected) in [
        (3, "QC 0.115 -0.920 0.000 0.000 65535 4294967295 *7C1B\n"),
        (
            4,
            "QC 0.1150 -0.9198 0.0000 0.0000 65535 4294967295 *10A8\n",
        ),
        (
            5,
            "QC 0.11498 -0.91982 0.00000 0.00000 65535 4294967295 *FCBA\n",
        ),
        (
            6,
            "QC 0.11498 -0.91982 0.00000 0.00000 65535 4294967295 *FCBA\n",
        ),
    ] {
        assert_eq!(wire::timed(some, LATE, decimals(number)), expected);
    }
}

#[test]
fn the_longest_line_is_one_packet() {
    let longest = wire::timed(Q30([i32::MIN; 4]), LATE, decimals(6));
    assert_eq!(
        longest,
        "QC -2.00000 -2.00000 -2.00000 -2.00000 65535 4294967295 *7B28\n"
    );
    assert_eq!(longest.len(), 62);
    assert!(longest.len() <= PACKET_LEN);
    assert_eq!(line([i32::MIN; 4], 6).len(), 43);
}

#[test]
fn numbers_are_rounded_exactly_with_halves_away_from_zero() {
    const ONE: i32 = 1 << 30;
    for (q, number, expected) in [
        (
            [ONE / 16, -ONE / 16, ONE / 16 * 3, ONE],
            3,
            "QC 0.063 -0.063 0.188 1.000\n",
        ),
        (
            [ONE / 16 - 1, 1 - ONE / 16, 0, 0],
            3,
            "QC 0.062 -0.062 0.000 0.000\n",
        ),
        (
            [ONE / 128, -ONE / 128, 0, 0],
            6,
            "QC 0.007813 -0.007813 0.000000 0.000000\n",
        ),
        // Half a thousandth is 536870.912 bits.
        (
            [536_870, -536_870, 536_871, -536_871],
            3,
            "QC 0.000 0.000 0.001 -0.001\n",
        ),
        (
            [-1, 1, i32::MAX, i32::MIN],
            6,
            "QC 0.000000 0.000000 2.000000 -2.000000\n",
        ),
    ] {
        assert_eq!(line(q, number), expected);
    }
    let mut random = Random(3);
    for _ in 0..200_000 {
        let bits = random.between(-2_147_483_648.0, 2_147_483_647.0) as i32;
        for number in 3..=6 {
            let one = 10_i64.pow(number);
            let steps = (i64::from(bits).abs() * one * 2 + (1 << 30)) >> 31;
            let sign = if bits < 0 && steps > 0 { "-" } else { "" };
            let (whole, rest, width) = (steps / one, steps % one, number as usize);
            let expected = format!("QC {sign}{whole}.{rest:0width$} ");
            assert!(
                line([bits, 0, 0, 0], number).starts_with(&expected),
                "{bits}"
            );
        }
    }
}

/// From 2⁻⁷ on 30 bits hold a float exactly; below it is rounded to them first.
#[test]
fn a_float_of_single_precision_is_written_as_by_itself_to_the_bit_that_30_bits_have() {
    let check = |value: f32| {
        let q = UnitQuaternion::new_unchecked(Quaternion::new(value, 0.0, 0.0, 0.0));
        for number in 3..=6 {
            let written = wire::quaternion(Tag::Gyro, Q30::from(&q), decimals(number));
            if value.abs() >= 0.007_812_5 {
                let expected = format!("QG {} ", Decimal(value, number));
                assert!(written.starts_with(&expected), "{value:e}: {written}");
                continue;
            }
            let printed: f64 = written.split(' ').nth(1).unwrap().parse().unwrap();
            let allowed = 0.5 / 10_f64.powi(number as i32) + 0.5 / f64::from(1 << 30);
            assert!(
                (printed - f64::from(value)).abs() <= allowed + 1e-15,
                "{value:e}: {written}"
            );
        }
    };
    let around = |half: f32| [half.next_down(), half, half.next_up()].into_iter();
    // Every half of three and of four decimals, and many of six, with the floats on either side.
    for one in [1000, 10_000] {
        let halves = (0..one).map(|step| (f64::from(step) + 0.5) / f64::from(one));
        halves.flat_map(|half| around(half as f32)).for_each(check);
    }
    let mut random = Random(4);
    for _ in 0..300_000 {
        let step = random.between(-1_000_000.0, 1_000_000.0).floor();
        around(((step + 0.5) / 1e6) as f32).for_each(check);
        check(random.between(-1.0, 1.0) as f32);
    }
    around(0.007_812_5)
        .chain(around(-0.007_812_5))
        .for_each(check);
    let ends = [0.0, -0.0, 1.0, -1.0, f32::MIN_POSITIVE, f32::from_bits(1)];
    ends.into_iter().for_each(check);
}

#[test]
fn what_is_no_number_is_still_digits() {
    let q = Quaternion::new(f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1e30);
    let q = Q30::from(&UnitQuaternion::new_unchecked(q));
    assert_eq!(q, Q30([0, i32::MAX, -i32::MAX, -i32::MAX]));
    assert_eq!(line(q.0, 3), "QC 0.000 2.000 -2.000 -2.000\n");
}

#[test]
fn the_checksum_is_the_one_of_its_polynomial() {
    assert_eq!(crc16(b"123456789"), 0x29B1);
    assert_eq!(crc16(b""), 0xFFFF);
    let mut random = Random(5);
    for length in 0..200 {
        let bytes: Vec<u8> = (0..length)
            .map(|_| random.between(0.0, 256.0) as u8)
            .collect();
        let by_bits = bytes.iter().fold(0xFFFF_u16, |crc, &byte| {
            (0..8).fold(crc ^ u16::from(byte) << 8, |crc, _| {
                let carried = crc & 0x8000 != 0;
                crc << 1 ^ if carried { 0x1021 } else { 0 }
            })
        });
        assert_eq!(crc16(&bytes), by_bits);
    }
}
