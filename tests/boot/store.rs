//! What outlives the supply: kept, found again, and never wrong, wherever the power is cut.
//!
//! Two images: the tracker's, and `keeper`, which keeps a record of the number that is typed.

use std::path::PathBuf;
use std::sync::OnceLock;

use vrduino::calibration::record::Record;
use vrduino_emulator::board::Setup;
use vrduino_emulator::board::setup::Eeprom;
use vrduino_emulator::firmware::{self, BuildOptions, Package};
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::time::{self, MICROSECOND, MILLISECOND};
use vrduino_emulator::witness::Trap;

use crate::run::Run;

/// Both slots, at the end of 2 KiB.
const SLOTS: [usize; 2] = [1536, 1792];
/// Where the record begins in a slot.
const CONTENT: usize = 12;
const RECORD: usize = 140;

fn keeper() -> Image {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let package = Package {
            name: "vrduino",
            feature: "keeper",
        };
        firmware::build_package(package, BuildOptions { quiet: true }).expect("the keeper builds")
    });
    Image::open(&folder.join("keeper")).expect("the emulator accepts the keeper")
}

fn still(eeprom: Eeprom) -> Setup {
    Setup::new(Box::new(Turns::new(1e6, 0.0))).with_eeprom(eeprom)
}

/// The keeper at work, on a board that finds this in its EEPROM.
fn boot(eeprom: Eeprom) -> Run {
    let mut run = Run::of(keeper(), still(eeprom));
    run.wait_for("vrduino ", 2.0);
    // The sensor takes a while, and keys wait for it.
    run.board.chip().host.send(b"r");
    run.wait_for("overruns\n", 2.0);
    run
}

fn keep(run: &mut Run, key: u8) {
    run.forget();
    run.board.chip().host.send(&[key]);
    run.wait_for("calibration ", 1.0);
    run.wait_for("\n", 0.1);
    assert!(run.text.contains("calibration kept\n"), "{}", run.text);
}

/// The record that the board has found at start.
fn found(run: &mut Run) -> Option<Record> {
    run.forget();
    run.board.chip().host.send(b"br");
    run.wait_for("overruns\n", 1.0);
    let digits: String = run
        .text
        .lines()
        .filter_map(|line| line.strip_prefix("found "))
        .collect();
    if digits == "nothing" {
        return None;
    }
    let byte = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).expect("hexadecimal");
    let bytes: Vec<u8> = (0..digits.len()).step_by(2).map(byte).collect();
    Some(Record::from_bytes(&bytes).expect("it shows a record"))
}

/// What is told apart: the keeper's records have 20 °C and their number.
fn number(record: Option<Record>) -> Option<u32> {
    record.map(|record| record.gyro.expect("there is one").temperature_celsius as u32 - 20)
}

/// An EEPROM with the record 1, or with 1 and 2.
fn with_records(keys: &[u8]) -> Eeprom {
    let mut run = boot(Eeprom::default());
    for &key in keys {
        keep(&mut run, key);
    }
    run.board.eeprom()
}

#[test]
fn what_is_kept_is_found_after_a_power_cycle() {
    let mut run = boot(Eeprom::default());
    assert_eq!(found(&mut run), None);
    assert!(!run.text.contains("warning"), "{}", run.text);
    keep(&mut run, b'3');
    let eeprom = run.board.eeprom();
    let there = &eeprom.bytes()[SLOTS[0] + CONTENT..][..RECORD];
    let there = Record::from_bytes(there).expect("the slot holds a record");

    let mut run = boot(eeprom);
    let record = found(&mut run).expect("it is found");
    assert_eq!(record, there);
    assert_eq!(number(Some(record)), Some(3));
    for (key, number_kept) in [(b'4', 4), (b'5', 5), (b'1', 1)] {
        keep(&mut run, key);
        run = boot(run.board.eeprom());
        assert_eq!(number(found(&mut run)), Some(number_kept));
        assert!(!run.text.contains("warning"), "{}", run.text);
    }
}

#[test]
fn a_system_reset_is_no_worse_than_a_power_cycle() {
    let still = still(Eeprom::default()).allowing(&[Trap::WatchdogTimeout]);
    let mut run = Run::of(keeper(), still);
    run.wait_for("vrduino ", 2.0);
    run.seconds(0.5);
    keep(&mut run, b'2');
    let address = run.board.image().address_of("rust_begin_unwind");
    run.board.jump(address.expect("the panic handler is there"));
    run.wait_for("warning: reset by watchdog", 3.0);
    run.seconds(0.5);
    assert_eq!(number(found(&mut run)), Some(2));
}

/// Numbers in "1172 samples, 0 repeated, 0 overruns".
fn counted(run: &mut Run) -> [u32; 3] {
    run.forget();
    run.board.chip().host.send(b"r");
    run.wait_for("overruns\n", 1.0);
    let line = run.text.lines().find(|line| line.ends_with("overruns"));
    let numbers: Vec<u32> = line
        .expect("it waited for it")
        .split(' ')
        .filter_map(|word| word.parse().ok())
        .collect();
    numbers.try_into().expect("three numbers")
}

#[test]
fn no_sample_is_lost_and_no_watchdog_bites_while_it_is_kept() {
    let mut run = boot(Eeprom::default());
    let (began, before) = (run.board.now(), counted(&mut run));
    let mut slowest = 0.0_f64;
    for key in *b"12345" {
        let start = run.board.now();
        keep(&mut run, key);
        slowest = slowest.max(time::seconds(run.board.now() - start));
    }
    // 38 words, one a millisecond, and the way of the key and the answer.
    assert!((0.038..0.080).contains(&slowest), "kept in {slowest} s");
    let after = counted(&mut run);
    let elapsed = time::seconds(run.board.now() - began) * 1e3;
    let samples = f64::from(after[0] - before[0]);
    // Both counts were asked for by key, each of which takes up to some 20 ms.
    assert!(
        (samples - elapsed).abs() < 20.0,
        "{samples} samples in {elapsed} ms"
    );
    assert_eq!(after[1..], [0, 0], "repeated samples, overruns");
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn only_what_differs_is_written() {
    let mut run = boot(Eeprom::default());
    let writes = |run: &mut Run| run.board.chip().flash.eeprom_writes;
    keep(&mut run, b'1');
    let first = writes(&mut run);
    assert!((30..=38).contains(&first), "{first} words");
    keep(&mut run, b'1');
    assert_eq!(writes(&mut run), first, "the same again");
    keep(&mut run, b'2');
    keep(&mut run, b'3');
    let before = writes(&mut run);
    keep(&mut run, b'4');
    assert!(writes(&mut run) - before <= 38);
}

#[test]
fn what_a_sketch_keeps_is_left_alone() {
    let sketch: Vec<u8> = (0..2048_u32).map(|n| (n * 7 + 3) as u8).collect();
    let mut run = boot(Eeprom::new(sketch.clone()).expect("2 KiB"));
    // What the sketch has left in our place is no record.
    assert!(
        run.text
            .contains("warning: no calibration: what was kept is damaged"),
        "{}",
        run.text
    );
    assert_eq!(found(&mut run), None);
    keep(&mut run, b'1');
    keep(&mut run, b'2');
    let eeprom = run.board.eeprom();
    assert_eq!(eeprom.bytes()[..SLOTS[0]], sketch[..SLOTS[0]]);
    assert_eq!(number(found(&mut boot(eeprom))), Some(2));
}

#[test]
fn a_smaller_eeprom_is_used_at_its_end_and_one_without_room_is_told() {
    let mut run = boot(Eeprom::new(vec![0xFF; 1024]).expect("1 KiB"));
    keep(&mut run, b'1');
    let eeprom = run.board.eeprom();
    assert!(eeprom.bytes()[..512].iter().all(|&byte| byte == 0xFF));
    assert_eq!(number(found(&mut boot(eeprom))), Some(1));

    let mut run = boot(Eeprom::new(vec![0xFF; 256]).expect("a quarter"));
    let told = "FlexNVM is partitioned otherwise: erase the whole chip";
    assert!(run.text.contains(told), "{}", run.text);
    run.board.chip().host.send(b"1");
    run.wait_for(&format!("not begun: {told}"), 1.0);
}

#[test]
fn damaged_bytes_are_refused() {
    let good = with_records(b"12");
    assert_eq!(number(found(&mut boot(good.clone()))), Some(2));
    // Checksum, number, length, first and last byte of the content.
    for offset in [0, 5, 8, CONTENT, CONTENT + RECORD - 1] {
        let mut damaged = good.clone();
        damaged.bytes_mut()[SLOTS[1] + offset] ^= 0x10;
        let mut run = boot(damaged.clone());
        let told = "warning: the last calibration was not kept whole";
        assert!(run.text.contains(told), "{offset}: {}", run.text);
        assert_eq!(number(found(&mut run)), Some(1), "{offset}");

        damaged.bytes_mut()[SLOTS[0] + offset] ^= 0x01;
        let mut run = boot(damaged);
        let told = "warning: no calibration: what was kept is damaged";
        assert!(run.text.contains(told), "{offset}: {}", run.text);
        assert_eq!(found(&mut run), None, "{offset}");
    }
}

/// A whole slot whose content is no record, as another firmware might leave it.
#[test]
fn a_slot_with_something_else_is_refused_by_the_record() {
    let mut eeprom = with_records(b"1");
    let slot = &mut eeprom.bytes_mut()[SLOTS[0]..];
    slot[CONTENT + 2] = 9; // the record's version
    let end = CONTENT + RECORD;
    let checksum = vrduino::calibration::record::crc32(&slot[4..end]);
    slot[..4].copy_from_slice(&checksum.to_le_bytes());
    let mut run = boot(eeprom);
    let told = "warning: no calibration: version 9 instead of 1";
    assert!(run.text.contains(told), "{}", run.text);
    assert_eq!(found(&mut run), None);
}

/// The power is cut every 1.7 ms from the key on, mostly in the middle of a word, which is then spoilt.
/// Returns what the next life finds after each.
fn cut(run: &Run, key: u8) -> Vec<Option<u32>> {
    let booted = run.board.snapshot();
    let after = |span| {
        let mut board = booted.board();
        board.chip().host.send(&[key]);
        board.run(span);
        board.eeprom()
    };
    let (old, new) = (booted.board().eeprom(), after(100 * MILLISECOND));
    let cuts: Vec<Eeprom> = (0..42).map(|n| after(n * 1700 * MICROSECOND)).collect();
    let neither = |(n, byte): (usize, &u8)| *byte != old.bytes()[n] && *byte != new.bytes()[n];
    let spoilt = |eeprom: &Eeprom| eeprom.bytes().iter().enumerate().any(neither);
    let spoilt = cuts.iter().filter(|eeprom| spoilt(eeprom)).count();
    assert!(spoilt > 5, "{spoilt} cuts within a word");
    let finds = |eeprom| number(found(&mut boot(eeprom)));
    cuts.into_iter().map(finds).collect()
}

#[test]
fn power_lost_while_saving_leaves_the_old_record_or_the_new_one() {
    let mut run = boot(Eeprom::default());
    let first = cut(&run, b'1');
    assert_old_then_new(&first, None, Some(1));
    keep(&mut run, b'1');
    assert_old_then_new(&cut(&run, b'2'), Some(1), Some(2));
    keep(&mut run, b'2');
    // Now both slots are in use.
    assert_old_then_new(&cut(&run, b'3'), Some(2), Some(3));
}

fn assert_old_then_new(numbers: &[Option<u32>], old: Option<u32>, new: Option<u32>) {
    let change = numbers.iter().position(|&number| number != old);
    let change = change.unwrap_or_else(|| panic!("never kept: {numbers:?}"));
    assert!(change > 5, "{numbers:?}");
    assert!(
        numbers[change..].iter().all(|&number| number == new),
        "{numbers:?}"
    );
}

#[test]
fn an_eeprom_that_hangs_is_told_and_sampling_goes_on() {
    let mut run = boot(Eeprom::default());
    run.board.chip().flash.stuck = true;
    run.board.chip().host.send(b"1");
    run.wait_for(
        "error: calibration not kept: the EEPROM does not answer",
        1.0,
    );
    let before = counted(&mut run)[0];
    run.seconds(0.5);
    assert!(counted(&mut run)[0] - before >= 500);
    assert_eq!(run.board.resets(), 0);
    run.board.chip().host.send(b"2");
    run.wait_for("not begun: the EEPROM does not answer", 1.0);
}

#[test]
fn making_the_eeprom_is_not_tried_again_after_it_hung() {
    let setup = still(Eeprom::default()).allowing(&[Trap::WatchdogTimeout]);
    let mut run = Run::of(keeper(), setup);
    run.board.chip().flash.stuck = true;
    run.wait_for("warning: reset by watchdog while making the EEPROM", 3.0);
    run.wait_for("warning: no calibration: making the EEPROM hung", 0.1);
    run.seconds(0.5);
    assert!(counted(&mut run)[0] > 300);
    assert_eq!(run.board.resets(), 1);
    // After a power cycle it is.
    keep(&mut boot(run.board.eeprom()), b'1');
}

#[test]
fn the_tracker_makes_the_eeprom_once_and_says_what_is_damaged() {
    let mut run = Run::still();
    assert!(run.board.eeprom().bytes().is_empty());
    run.wait_for("QC ", 3.0);
    assert!(!run.text.contains("warning"), "{}", run.text);
    let made = run.board.eeprom();
    assert_eq!(made.bytes(), [0xFF; 2048]);
    assert_eq!(run.board.chip().flash.eeprom_writes, 0);

    let mut damaged = with_records(b"1");
    damaged.bytes_mut()[SLOTS[0] + 50] ^= 1;
    let mut run = Run::with(still(damaged));
    run.wait_for("warning: no calibration: what was kept is damaged", 2.0);
    run.wait_for("QC ", 3.0);
}
