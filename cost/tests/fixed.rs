//! The filter in fixed point on the chip: the same bits as on the host, and what it costs.

#[path = "image/mod.rs"]
mod image;

use image::{Counted, table};
use vrduino::fixed::multiply::Portable;
use vrduino_cost_images::motion::{Motion, Random, SAMPLES};
use vrduino_emulator::board::Board;
use vrduino_emulator::time::MILLISECOND;

/// Instructions of a whole update, bias and parameters included, up to 45° from level: always the same number.
const NEAR_LEVEL: u64 = 215;
/// Most that any input may cost.
const WORST: u64 = 600;

const IMAGE: Counted = Counted("fixed-complementary");

/// The board when it has gone through every motion; it has counted the calls of `function`.
fn at_the_end(function: &str) -> Board {
    IMAGE.after(function, Motion::ALL.len())
}

#[test]
fn near_level_every_update_costs_the_same() {
    // Well before anything comes: level first, then tilted.
    let mut board = IMAGE.board("by_instructions");
    while board.measure().calls.count < u64::from(SAMPLES) * 3 / 2 {
        board.run(MILLISECOND);
        assert!(board.stop().is_none(), "{}", board.stop().unwrap());
        assert!(board.variable("DONE").is_some_and(|done| done < 2));
    }
    let calls = board.measure().calls;
    println!("{} instructions near level", calls.most_instructions);
    assert_eq!(calls.instructions, calls.count * calls.most_instructions);
    assert!(calls.most_instructions <= NEAR_LEVEL, "{calls:?}");
}

#[test]
fn no_input_costs_more_than_the_budget() {
    for function in ["by_instructions", "portable"] {
        let calls = at_the_end(function).measure().calls;
        println!(
            "{function}: {} instructions at most",
            calls.most_instructions
        );
        assert_eq!(calls.count, u64::from(SAMPLES) * Motion::ALL.len() as u64);
        assert!(calls.most_instructions <= WORST, "{function}: {calls:?}");
    }
}

#[test]
fn board_and_host_compute_the_same_bits() {
    let board = at_the_end("portable");
    assert_eq!(board.variable("DIFFERENT"), Some(0));
    let words = table(&board, "ORIENTATIONS", 4 * Motion::ALL.len());
    for (motion, on_board) in Motion::ALL.into_iter().zip(words.chunks_exact(4)) {
        let mut filter = motion.filter::<Portable>();
        let mut random = Random::default();
        for number in 0..SAMPLES {
            filter.update(&motion.sample(number, &mut random));
        }
        assert_eq!(filter.bits(), on_board, "{motion:?}");
    }
}

/// No library routine, so no floating point in software and no panic; and no instruction of a floating-point unit.
#[test]
fn an_update_calls_nothing_but_its_own_slow_path() {
    let ours = ["by_instructions", "portable", "fixed"];
    let seen = IMAGE.called_from(&ours[..2]);
    println!("{seen:?}");
    assert!(seen.len() >= 4, "the slow paths were not found: {seen:?}");
    for name in &seen {
        assert!(
            ours.iter().any(|ours| name.contains(ours)),
            "{name} is called"
        );
        assert!(!name.contains("panic"), "{name} is called");
    }
}
