//! A board can be copied at any moment.

use vrduino_emulator::board::Board;
use vrduino_emulator::time;

use crate::tracker::{board, run, setup};

fn lines(text: &[u8]) -> usize {
    text.split(|&byte| byte == b'\n')
        .filter(|line| line.starts_with(b"QC "))
        .count()
}

#[test]
fn a_run_goes_on_from_a_snapshot_as_if_nothing_had_been() {
    let mut original = board(setup());
    run(&mut original, 1.5);
    let snapshot = original.snapshot();
    let account = |board: &mut Board| (run(board, 0.5), board.state_hash(), board.instructions());
    let untouched = account(&mut original);
    assert!(lines(&untouched.0) > 10);
    for _ in 0..2 {
        assert_eq!(account(&mut snapshot.board()), untouched);
    }
    original.resume(&snapshot);
    assert_eq!(account(&mut original), untouched);
}

#[test]
fn a_snapshot_can_be_taken_at_any_moment_of_the_start() {
    let mut original = board(setup());
    for _ in 0..60 {
        // No multiple of a frame: in the middle of packets, handlers and sleep.
        run(&mut original, 0.012_345_7);
        let mut copy = original.snapshot().board();
        assert_eq!(copy.state_hash(), original.state_hash());
        run(&mut copy, 0.000_7);
        let mut second = original.snapshot().board();
        run(&mut second, 0.000_7);
        assert_eq!(copy.state_hash(), second.state_hash());
    }
}

/// Fifty faults at moments within two samples, from one boot: wherever the fault hits, the stream comes back.
#[test]
fn the_stream_comes_back_from_a_fault_at_any_moment() {
    let mut booted = board(setup());
    run(&mut booted, 1.5);
    let booted = booted.snapshot();
    type Hit = fn(&mut Board);
    let faults: [(&str, Hit); 2] = [
        ("stuck-sda", |board| board.chip().pins.sda_held_for = 5),
        ("brown-out", |board| {
            let now = board.now();
            board.chip().sensor.brown_out(now);
        }),
    ];
    for (name, hit) in faults {
        for moment in 0..25 {
            let mut board = booted.board();
            run(&mut board, 0.000_2 * f64::from(moment));
            hit(&mut board);
            // The firmware notices at once, or never if it did not matter.
            let mut stream = run(&mut board, 0.1);
            let before = lines(&stream);
            while lines(&stream) < before + 5 {
                let said = String::from_utf8_lossy(&stream);
                assert!(
                    board.now() < time::ticks(4.5),
                    "{name} at {moment}:\n{said}"
                );
                stream.extend(run(&mut board, 0.1));
            }
            assert_eq!(board.resets(), 0, "{name} at moment {moment}");
        }
    }
}
