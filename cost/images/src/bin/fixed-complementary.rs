//! The complementary filter in fixed point: each motion with the multiply instructions and in plain Rust.
//!
//! The functions `by_instructions` and `portable` are what is counted. What both end at is left in
//! `ORIENTATIONS`, and `DIFFERENT` says how often they were not the same to the last bit.

#![no_std]
#![no_main]

#[path = "../../../../src/board/multiply.rs"]
mod multiply;
#[path = "../watchdog.rs"]
mod watchdog;

use core::sync::atomic::{AtomicU32, Ordering};
use mk20dx_hal as _; // the interrupt vectors and the flash configuration field
use multiply::Instructions;
use panic_halt as _;
use vrduino::fixed::complementary::Complementary;
use vrduino::fixed::multiply::{Multiply, Portable};
use vrduino::sensor::RawSample;
use vrduino_cost_images::motion::{Motion, Random, SAMPLES};

/// w, x, y, z at the end of each motion, as the bits of Q30.
#[unsafe(no_mangle)]
static ORIENTATIONS: [AtomicU32; 16] = [const { AtomicU32::new(0) }; 16];

/// Samples after which the two were not the same.
#[unsafe(no_mangle)]
static DIFFERENT: AtomicU32 = AtomicU32::new(0);

/// Motions that have ended.
#[unsafe(no_mangle)]
static DONE: AtomicU32 = AtomicU32::new(0);

#[inline(never)]
fn by_instructions(filter: &mut Complementary<Instructions>, sample: &RawSample) {
    filter.update(sample);
}

#[inline(never)]
fn portable(filter: &mut Complementary<Portable>, sample: &RawSample) {
    filter.update(sample);
}

fn run(motion: Motion) -> [i32; 4] {
    let mut one: Complementary<Instructions> = motion.filter();
    let mut other: Complementary<Portable> = motion.filter();
    let mut random = Random::default();
    for number in 0..SAMPLES {
        let sample = motion.sample(number, &mut random);
        by_instructions(&mut one, &sample);
        portable(&mut other, &sample);
        if one.bits() != other.bits() {
            DIFFERENT.store(DIFFERENT.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        }
    }
    one.bits()
}

/// Both forms of each operation, on anything.
fn compare_products() {
    let mut bits = 1_u32;
    let mut next = || {
        bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (bits ^ bits >> 15) as i32
    };
    for _ in 0..10_000 {
        let (sum, a, b) = (next(), next(), next());
        let same = Instructions::high(a, b) == Portable::high(a, b)
            && Instructions::add_wide(i64::from(sum) << 20, a, b)
                == Portable::add_wide(i64::from(sum) << 20, a, b)
            && Instructions::add_high(sum, a, b) == Portable::add_high(sum, a, b)
            && Instructions::subtract_high(sum, a, b) == Portable::subtract_high(sum, a, b);
        if !same {
            DIFFERENT.store(DIFFERENT.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        }
    }
}

#[cortex_m_rt::entry]
fn main() -> ! {
    compare_products();
    for (motion, words) in Motion::ALL.into_iter().zip(ORIENTATIONS.chunks_exact(4)) {
        for (word, bits) in words.iter().zip(run(motion)) {
            word.store(bits as u32, Ordering::Relaxed);
        }
        DONE.store(DONE.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
    }
    loop {
        core::hint::spin_loop();
    }
}
