//! The default estimator in fixed point on the chip: the same bits as on the host, and what it costs.

#[path = "image/mod.rs"]
mod image;

use image::{Counted, run_until, table};
use vrduino::fixed::multiply::Portable;
use vrduino_cost_images::fusion::{Motion, SAMPLES};
use vrduino_cost_images::motion::Random;

/// Instructions of a whole update without a field, start, rest and bias included: the mean, and most after the
/// first sample.
const MEAN: u64 = 260;
const MOST: u64 = 360;
/// Most with a field.
const WITH_FIELD: u64 = 640;
/// Most that any input may cost, a first sample with a field among it.
const WORST: u64 = 1_000;
/// The same in plain Rust, which no board runs.
const WORST_PORTABLE: u64 = 1_300;

const IMAGE: Counted = Counted("fixed-fusion");

#[test]
fn six_axes_stay_within_their_budget() {
    let mut board = IMAGE.board("six_axes");
    let mut before = 0;
    for (index, motion) in Motion::ALL.into_iter().take(3).enumerate() {
        let counted = board.measure().calls;
        run_until(&mut board, index + 1);
        let calls = board.measure().calls;
        let count = calls.count - counted.count;
        let mean = (calls.instructions - counted.instructions) as f64 / count as f64;
        println!(
            "{motion:?}: {mean:.1} instructions on average, {} at most so far",
            calls.most_instructions
        );
        before += count;
        assert_eq!(before, calls.count);
        assert!(mean <= MEAN as f64, "{motion:?}: {mean}");
    }
    let calls = board.measure().calls;
    assert!(calls.most_instructions <= MOST, "{calls:?}");
}

#[test]
fn no_input_costs_more_than_the_budget() {
    for (function, most) in [
        ("nine_axes", WITH_FIELD),
        ("anything", WORST),
        ("portable", WORST_PORTABLE),
    ] {
        let calls = IMAGE.after(function, Motion::ALL.len()).measure().calls;
        println!(
            "{function}: {} instructions at most, {:.1} on average",
            calls.most_instructions,
            calls.instructions as f64 / calls.count as f64
        );
        assert!(calls.count > 0, "{function} was not called");
        assert!(calls.most_instructions <= most, "{function}: {calls:?}");
    }
}

#[test]
fn board_and_host_compute_the_same_bits() {
    let board = IMAGE.after("portable", Motion::ALL.len());
    assert_eq!(board.variable("DIFFERENT"), Some(0));
    let words = table(&board, "ORIENTATIONS", 4 * Motion::ALL.len());
    for (motion, on_board) in Motion::ALL.into_iter().zip(words.chunks_exact(4)) {
        let mut filter = Motion::filter::<Portable>();
        let mut random = Random::default();
        for number in 0..SAMPLES {
            let (sample, field) = motion.sample(number, &mut random);
            motion.prepare(number, &mut filter, &sample);
            filter.update(&sample, field);
        }
        assert_eq!(filter.bits(), on_board, "{motion:?}");
    }
}

/// No library routine, so no floating point in software, no long division and no panic; and no instruction of a
/// floating-point unit.
#[test]
fn an_update_calls_nothing_but_its_own_parts() {
    let functions = ["six_axes", "nine_axes", "anything", "portable"];
    let seen = IMAGE.called_from(&functions);
    println!("{seen:?}");
    assert!(seen.len() > functions.len(), "no parts: {seen:?}");
    for name in &seen {
        let own = functions.iter().any(|function| name.contains(function));
        assert!(own || name.contains("fixed"), "{name} is called");
        assert!(!name.contains("panic"), "{name} is called");
    }
}
