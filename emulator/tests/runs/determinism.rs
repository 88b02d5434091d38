//! The same run, twice.

use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::cpu::Pace;

use crate::tracker::{board, run, setup, small_image};

/// Everything that can be said of a run.
fn account(board: &mut Board, seconds: f64) -> (Vec<u8>, u64, u64, String) {
    let received = run(board, seconds);
    assert!(board.stop().is_none(), "{}", board.stop().unwrap());
    let measure = format!("{:?}", board.measure());
    (received, board.state_hash(), board.instructions(), measure)
}

#[test]
fn two_runs_are_equal_byte_for_byte_and_in_their_state() {
    let (mut one, mut other) = (board(setup()), board(setup()));
    for _ in 0..4 {
        let (first, second) = (account(&mut one, 0.4), account(&mut other, 0.4));
        assert_eq!(first, second);
    }
    assert!(!run(&mut one, 0.1).is_empty());
}

#[test]
fn a_difference_anywhere_shows_in_the_state() {
    let mut reference = board(setup());
    run(&mut reference, 1.0);
    let hash = reference.state_hash();
    assert_eq!(reference.state_hash(), hash, "looking changes nothing");
    let snapshot = reference.snapshot();
    type Change = fn(&mut Board);
    let changes: [(&str, Change); 8] = [
        ("a byte of RAM", |board| {
            let last = 0x2000_0000;
            let word = board.chip().ram.word(last).unwrap();
            board.chip().ram.set_word(last, word ^ 1);
        }),
        ("the program counter", |board| board.jump(0x410)),
        ("a wire", |board| board.chip().pins.scl_held = true),
        ("the sensor", |board| {
            board.chip().sensor.faults.frozen = true
        }),
        ("a peripheral", |board| {
            board.chip().write(0x4003_7100, 4, 1234);
        }),
        ("a register of no model", |board| {
            board.chip().write(0x4000_0020, 4, 1);
        }),
        ("the host", |board| board.chip().host.send(b"2")),
        ("time", |board| board.run(1)),
    ];
    for (what, change) in changes {
        let mut board = snapshot.board();
        assert_eq!(board.state_hash(), hash);
        change(&mut board);
        assert_ne!(board.state_hash(), hash, "{what}");
    }
}

/// The proof of [`Setup::skip_polling`]: no cycle, no measurement and no result depends on it.
#[test]
fn passing_over_polling_loops_changes_nothing() {
    for pace in [Pace::Least, Pace::Greatest] {
        let with = |skip_polling| Setup {
            skip_polling,
            pace,
            timed_function: "Tracker::update".into(),
            ..setup()
        };
        let (mut skipping, mut plodding) = (board(with(true)), board(with(false)));
        for _ in 0..12 {
            let (one, other) = (account(&mut skipping, 0.1), account(&mut plodding, 0.1));
            assert_eq!(one, other, "{pace:?} at {}", skipping.now());
        }
    }
}

/// A loop that waits for what SysTick counts; the handler adds to the word at 0x2000_0000.
#[rustfmt::skip]
const WAITS_FOR_SYSTICK: [u16; 40] = [
    // Watchdog: unlock, switch off.
    0x480D, 0xF24C, 0x5120, 0xF64D, 0x1228, 0x8001, 0x8002, 0x480B, 0xF240, 0x11D2, 0x8001,
    // SysTick: reload 2999, interrupt, count.
    0x480A, 0xF640, 0x31B7, 0x6041, 0x2100, 0x6081, 0x2107, 0x6001,
    // mov r4, #0x20000000; movs r5, #0; str r5, [r4]
    0xF04F, 0x5400, 0x2500, 0x6025,
    // poll: ldr r6, [r4]; cmp r6, r5; beq poll; mov r5, r6; b poll
    0x6826, 0x42AE, 0xD0FC, 0x4635, 0xE7FA,
    // .word 0x4005200E, 0x40052000, 0xE000E010
    0x200E, 0x4005, 0x2000, 0x4005, 0xE010, 0xE000,
    // handler: mov r0, #0x20000000; ldr r1, [r0]; adds r1, #1; str r1, [r0]; bx lr
    0xF04F, 0x5000, 0x6801, 0x3101, 0x6001, 0x4770,
];

#[test]
fn passing_over_a_loop_that_waits_for_systick_changes_nothing() {
    for pace in [Pace::Least, Pace::Greatest] {
        let with = |skip_polling| {
            let setup = Setup {
                skip_polling,
                pace,
                ..setup()
            };
            Board::new(small_image(&WAITS_FOR_SYSTICK, &[(15, 0x454)]), setup)
        };
        let (mut skipping, mut plodding) = (with(true), with(false));
        for _ in 0..100 {
            // No multiple of anything.
            let (one, other) = (
                account(&mut skipping, 0.001_234_5),
                account(&mut plodding, 0.001_234_5),
            );
            assert_eq!(one, other, "{pace:?} at {}", skipping.now());
        }
        let count = skipping.chip().ram.word(0x2000_0000);
        assert!(count > Some(700), "{count:?}");
    }
}
