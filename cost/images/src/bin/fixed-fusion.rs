//! The default estimator in fixed point: each motion with the multiply instructions and in plain Rust.
//!
//! What is counted are the functions `six_axes` and `nine_axes`, `anything`, which takes first samples too, and
//! `portable`, which takes all of it. What both forms end at is left in `ORIENTATIONS`, and `DIFFERENT` says how often they were not the
//! same to the last bit.

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
use vrduino::fixed::fusion::{Field, Fusion};
use vrduino::fixed::multiply::Portable;
use vrduino::sensor::RawSample;
use vrduino_cost_images::fusion::{Motion, SAMPLES};
use vrduino_cost_images::motion::Random;

/// w, x, y, z at the end of each motion, as the bits of Q30.
#[unsafe(no_mangle)]
static ORIENTATIONS: [AtomicU32; 4 * Motion::ALL.len()] =
    [const { AtomicU32::new(0) }; 4 * Motion::ALL.len()];

/// Samples after which the two were not the same.
#[unsafe(no_mangle)]
static DIFFERENT: AtomicU32 = AtomicU32::new(0);

/// Motions that have ended.
#[unsafe(no_mangle)]
static DONE: AtomicU32 = AtomicU32::new(0);

#[inline(never)]
fn six_axes(filter: &mut Fusion<Instructions>, sample: &RawSample) {
    filter.update(sample, None);
}

#[inline(never)]
fn nine_axes(filter: &mut Fusion<Instructions>, sample: &RawSample, field: Field) {
    filter.update(sample, Some(field));
}

#[inline(never)]
fn anything(filter: &mut Fusion<Instructions>, sample: &RawSample, field: Option<Field>) {
    filter.update(sample, field);
}

#[inline(never)]
fn portable(filter: &mut Fusion<Portable>, sample: &RawSample, field: Option<Field>) {
    filter.update(sample, field);
}

fn run(motion: Motion) -> [i32; 4] {
    let mut one: Fusion<Instructions> = Motion::filter();
    let mut other: Fusion<Portable> = Motion::filter();
    let mut random = Random::default();
    for number in 0..SAMPLES {
        let (sample, field) = motion.sample(number, &mut random);
        motion.prepare(number, &mut one, &sample);
        motion.prepare(number, &mut other, &sample);
        match field {
            _ if number == 0 || !motion.is_usual() => anything(&mut one, &sample, field),
            None => six_axes(&mut one, &sample),
            Some(field) => nine_axes(&mut one, &sample, field),
        }
        portable(&mut other, &sample, field);
        if one.bits() != other.bits() {
            DIFFERENT.store(DIFFERENT.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        }
    }
    one.bits()
}

#[cortex_m_rt::entry]
fn main() -> ! {
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
