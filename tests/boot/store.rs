//! What outlives the supply: kept, found again, and never wrong, wherever the power is cut.

use nalgebra::{Matrix3, Vector3};
use vrduino::calibration::ellipsoid::Magnetometer;
use vrduino::calibration::record::{self, Gyro, Record};
use vrduino::calibration::six_positions::Accelerometer;
use vrduino::units::{Angle, AngularRate, MagneticField, SpecificForce};
use vrduino_emulator::board::Setup;
use vrduino_emulator::board::setup::Eeprom;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::time::{self, MICROSECOND, MILLISECOND};
use vrduino_emulator::witness::Trap;

use crate::run::Run;

/// Both slots, at the end of 2 KiB.
const SLOTS: [usize; 2] = [1536, 1792];
/// Where the record begins in a slot.
const CONTENT: usize = 12;

/// A record in which every value is another for each number.
fn record(number: u8) -> Record {
    let n = f32::from(number);
    let three = |first: f32| Vector3::new(first + n, first + n + 0.25, first + n + 0.5);
    Record {
        gyro: Some(Gyro {
            bias: AngularRate::from_dps(three(1.0)),
            temperature_celsius: 20.0 + n,
        }),
        accelerometer: Some(Accelerometer {
            bias: SpecificForce::from_m_per_s2(three(2.0) / 100.0),
            matrix: Matrix3::identity() * (1.0 + n / 1000.0) + Matrix3::repeat(n / 500.0),
            residual: (n + 1.0) / 100.0,
            placing: Angle::from_rad(4.0 + n),
            temperature_celsius: 21.0 + n,
        }),
        magnetometer: Some(Magnetometer {
            hard_iron: MagneticField::from_microtesla(three(5.0)),
            soft_iron: Matrix3::identity() * (1.0 + n / 100.0) + Matrix3::repeat(n / 500.0),
            strength_microtesla: 50.0 + n,
            error_percent: 1.0 + n,
            coverage: 0.5 + n / 100.0,
            largest_hole: Angle::from_rad(0.25 + n),
            temperature_celsius: 22.0 + n,
        }),
    }
}

fn still(eeprom: Eeprom) -> Setup {
    Setup::new(Box::new(Turns::new(1e6, 0.0))).with_eeprom(eeprom)
}

/// The tracker at work, on a board that finds this in its EEPROM.
fn boot(eeprom: Eeprom) -> Run {
    let mut run = Run::with(still(eeprom));
    run.wait_for("vrduino ", 2.0);
    run
}

/// Types a line and waits for a new line that begins with `answer`; returns it.
fn ask(run: &mut Run, line: &str, answer: &str) -> String {
    let from = run.text.len();
    let typed = format!("{line}\n");
    run.board.chip().host.send(typed.as_bytes());
    let deadline = run.board.now() + time::ticks(2.0);
    loop {
        run.seconds(0.002);
        let mut lines = run.text[from..].split_inclusive('\n');
        let found = lines.find(|one| one.starts_with(answer) && one.ends_with('\n'));
        if let Some(found) = found {
            return found.trim_end().to_owned();
        }
        let late = run.board.now() > deadline;
        assert!(!late, "no {answer:?} after {line:?}:\n{}", run.text);
    }
}

/// Gives the board the record, all but the word to use it.
fn hand_over(run: &mut Run, number: u8) {
    for (n, piece) in record(number).to_bytes().chunks(24).enumerate() {
        let digits: String = piece.iter().map(|byte| format!("{byte:02x}")).collect();
        ask(run, &format!(":keep {} {digits}", 24 * n), "OK keep");
    }
}

fn keep(run: &mut Run, number: u8) {
    hand_over(run, number);
    ask(run, ":keep done", "calibration kept");
}

/// The number of the record that the board uses.
fn found(run: &mut Run) -> Option<u8> {
    let answer = ask(run, ":calibration", "OK calibration");
    let number = (0..10).find(|&number| {
        let (n, known) = (number, "OK calibration: field");
        answer
            == format!(
                "{known} 5{n}.0 uT within {}.0 %, force within {:.3} m/s2",
                n + 1,
                f64::from(n + 1) / 100.0
            )
    });
    assert!(
        number.is_some() || answer == "OK calibration: none",
        "{answer}"
    );
    number
}

/// An EEPROM in which these were kept, one after the other.
fn with_records(numbers: &[u8]) -> Eeprom {
    let mut run = boot(Eeprom::default());
    for &number in numbers {
        keep(&mut run, number);
    }
    run.board.eeprom()
}

#[test]
fn what_is_kept_is_found_after_a_power_cycle() {
    let mut run = boot(Eeprom::default());
    assert_eq!(found(&mut run), None);
    assert!(!run.text.contains("no calibration"), "{}", run.text);
    for number in [3, 4, 5, 1] {
        keep(&mut run, number);
        run = boot(run.board.eeprom());
        assert_eq!(found(&mut run), Some(number));
        assert!(!run.text.contains("warning"), "{}", run.text);
    }
    // The first went into the first slot, and the third again.
    let eeprom = run.board.eeprom();
    for (slot, number) in SLOTS.into_iter().zip([5, 1]) {
        let kept = &eeprom.bytes()[slot + CONTENT..][..record::LENGTH];
        assert_eq!(kept, record(number).to_bytes());
    }
}

#[test]
fn what_is_forgotten_stays_forgotten() {
    let mut run = boot(with_records(&[3]));
    assert_eq!(found(&mut run), Some(3));
    ask(&mut run, ":forget", "calibration kept");
    assert_eq!(found(&mut boot(run.board.eeprom())), None);
}

#[test]
fn of_two_in_a_hurry_the_last_is_kept() {
    let mut run = boot(Eeprom::default());
    hand_over(&mut run, 2);
    for line in [":keep done\n", ":forget\n", ":keep done\n"] {
        run.board.chip().host.send(line.as_bytes());
        run.seconds(0.005);
    }
    run.seconds(0.2);
    assert_eq!(
        run.text.matches("calibration kept").count(),
        2,
        "{}",
        run.text
    );
    assert_eq!(found(&mut boot(run.board.eeprom())), Some(2));
}

#[test]
fn a_system_reset_is_no_worse_than_a_power_cycle() {
    let still = still(Eeprom::default()).allowing(&[Trap::WatchdogTimeout]);
    let mut run = Run::with(still);
    run.wait_for("vrduino ", 2.0);
    keep(&mut run, 2);
    let address = run.board.image().address_of("rust_begin_unwind");
    run.board.jump(address.expect("the panic handler is there"));
    run.wait_for("warning: reset by watchdog", 3.0);
    assert_eq!(found(&mut run), Some(2));
}

#[test]
fn no_sample_is_lost_or_late_while_it_is_kept() {
    let mut run = boot(Eeprom::default());
    run.wait_for("QC ", 2.0);
    run.board.chip().sensor.recording = Some(Vec::new());
    for number in 1..=4 {
        hand_over(&mut run, number);
        let start = run.board.now();
        ask(&mut run, ":keep done", "calibration kept");
        let took = time::seconds(run.board.now() - start);
        // 38 words, one a millisecond, and the way of the line and the answer.
        assert!((0.038..0.070).contains(&took), "kept in {took} s");
    }
    let recording = run.board.chip().sensor.recording.take();
    let bursts = recording.expect("it records");
    assert!(bursts.len() > 200, "{} bursts", bursts.len());
    for pair in bursts.windows(2) {
        let apart = pair[1].at - pair[0].at;
        let off = apart.abs_diff(MILLISECOND);
        // One that was asked for too early is asked for again.
        assert!(off < 140 * MICROSECOND, "{} s apart", time::seconds(apart));
    }
    // Nor did any find its queue full on the way to the filter.
    run.board.chip().host.send(b"0");
    run.wait_for("OVERRUNS: ", 1.5);
    run.seconds(0.1);
    for counter in ["OVERRUNS: 0", "REPEATED: 0", "DROPPED: 0"] {
        assert!(run.text.contains(counter), "no {counter}:\n{}", run.text);
    }
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn only_what_differs_is_written() {
    let mut run = boot(Eeprom::default());
    let writes = |run: &mut Run| run.board.chip().flash.eeprom_writes;
    keep(&mut run, 1);
    let first = writes(&mut run);
    assert!((30..=38).contains(&first), "{first} words");
    keep(&mut run, 1);
    assert_eq!(writes(&mut run), first, "the same again");
    for number in [2, 3] {
        let before = writes(&mut run);
        keep(&mut run, number);
        assert!((1..=38).contains(&(writes(&mut run) - before)));
    }
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
    keep(&mut run, 1);
    keep(&mut run, 2);
    let eeprom = run.board.eeprom();
    assert_eq!(eeprom.bytes()[..SLOTS[0]], sketch[..SLOTS[0]]);
    assert_eq!(found(&mut boot(eeprom)), Some(2));
}

#[test]
fn a_smaller_eeprom_is_used_at_its_end_and_one_without_room_is_told() {
    let mut run = boot(Eeprom::new(vec![0xFF; 1024]).expect("1 KiB"));
    keep(&mut run, 1);
    let eeprom = run.board.eeprom();
    assert!(eeprom.bytes()[..512].iter().all(|&byte| byte == 0xFF));
    assert_eq!(found(&mut boot(eeprom)), Some(1));

    let mut run = boot(Eeprom::new(vec![0xFF; 256]).expect("a quarter"));
    let told = "FlexNVM is partitioned otherwise: erase the whole chip";
    assert!(run.text.contains(told), "{}", run.text);
    hand_over(&mut run, 1);
    let told = format!("error: calibration not kept: {told}");
    ask(&mut run, ":keep done", &told);
}

#[test]
fn damaged_bytes_are_refused() {
    let good = with_records(&[1, 2]);
    assert_eq!(found(&mut boot(good.clone())), Some(2));
    // Checksum, number, length, first and last byte of the content.
    for offset in [0, 5, 8, CONTENT, CONTENT + record::LENGTH - 1] {
        let mut damaged = good.clone();
        damaged.bytes_mut()[SLOTS[1] + offset] ^= 0x10;
        let mut run = boot(damaged.clone());
        let told = "warning: the last calibration was not kept whole";
        assert!(run.text.contains(told), "{offset}: {}", run.text);
        assert_eq!(found(&mut run), Some(1), "{offset}");

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
    let mut eeprom = with_records(&[1]);
    let slot = &mut eeprom.bytes_mut()[SLOTS[0]..];
    slot[CONTENT + 2] = 9; // the record's version
    let end = CONTENT + record::LENGTH;
    let checksum = record::crc32(&slot[4..end]);
    slot[..4].copy_from_slice(&checksum.to_le_bytes());
    let mut run = boot(eeprom);
    let told = "warning: no calibration: version 9 instead of 1";
    assert!(run.text.contains(told), "{}", run.text);
    assert_eq!(found(&mut run), None);
}

/// The power is cut every 1.7 ms from the last line on, mostly in the middle of a word, which is then
/// spoilt. Returns what the next life finds after each.
fn cut(run: &mut Run, number: u8) -> Vec<Option<u8>> {
    hand_over(run, number);
    let booted = run.board.snapshot();
    let after = |span| {
        let mut board = booted.board();
        board.chip().host.send(b":keep done\n");
        board.run(span);
        board.eeprom()
    };
    let (old, new) = (booted.board().eeprom(), after(100 * MILLISECOND));
    let cuts: Vec<Eeprom> = (0..32).map(|n| after(n * 1700 * MICROSECOND)).collect();
    let neither = |(n, byte): (usize, &u8)| *byte != old.bytes()[n] && *byte != new.bytes()[n];
    let spoilt = |eeprom: &Eeprom| eeprom.bytes().iter().enumerate().any(neither);
    let spoilt = cuts.iter().filter(|eeprom| spoilt(eeprom)).count();
    assert!(spoilt > 5, "{spoilt} cuts within a word");
    let finds = |eeprom| found(&mut boot(eeprom));
    cuts.into_iter().map(finds).collect()
}

#[test]
fn power_lost_while_saving_leaves_the_old_record_or_the_new_one() {
    let mut run = boot(Eeprom::default());
    let none_before = cut(&mut run, 1);
    assert_old_then_new(&none_before, None, Some(1));
    keep(&mut run, 1);
    assert_old_then_new(&cut(&mut run, 2), Some(1), Some(2));
    keep(&mut run, 2);
    // Now both slots are in use.
    assert_old_then_new(&cut(&mut run, 3), Some(2), Some(3));
}

fn assert_old_then_new(numbers: &[Option<u8>], old: Option<u8>, new: Option<u8>) {
    let change = numbers.iter().position(|&number| number != old);
    let change = change.unwrap_or_else(|| panic!("never kept: {numbers:?}"));
    assert!(change > 5, "{numbers:?}");
    assert!(
        numbers[change..].iter().all(|&number| number == new),
        "{numbers:?}"
    );
}

#[test]
fn an_eeprom_that_hangs_is_told_and_tracking_goes_on() {
    let mut run = boot(Eeprom::default());
    hand_over(&mut run, 1);
    run.board.chip().flash.stuck = true;
    let told = "error: calibration not kept: the EEPROM does not answer";
    ask(&mut run, ":keep done", told);
    assert_eq!(found(&mut run), Some(1), "used all the same");
    ask(&mut run, ":keep done", told);
    let before = run.orientations.len();
    run.seconds(1.5);
    assert!(run.orientations.len() > before + 40);
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn making_the_eeprom_is_not_tried_again_after_it_hung() {
    let setup = still(Eeprom::default()).allowing(&[Trap::WatchdogTimeout]);
    let mut run = Run::with(setup);
    run.board.chip().flash.stuck = true;
    run.wait_for("warning: reset by watchdog while making the EEPROM", 3.0);
    run.wait_for("warning: no calibration: making the EEPROM hung", 0.1);
    run.wait_for("QC ", 2.0);
    assert_eq!(run.board.resets(), 1);
    // After a power cycle it is.
    keep(&mut boot(run.board.eeprom()), 1);
}

#[test]
fn the_eeprom_is_made_at_the_first_start_and_nothing_written() {
    let mut run = Run::still();
    assert!(run.board.eeprom().bytes().is_empty());
    run.wait_for("QC ", 3.0);
    assert!(!run.text.contains("warning"), "{}", run.text);
    assert_eq!(run.board.eeprom().bytes(), [0xFF; 2048]);
    assert_eq!(run.board.chip().flash.eeprom_writes, 0);
}
