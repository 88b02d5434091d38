//! Runs a filter on the chip, at 72 MHz.
//!
//! A program made by [`filters!`](crate::filters) waits at the end of `main`. Whoever counts makes it go on at the
//! function `run` of a filter's module, counts the calls of `update` beside it, and waits for `STATE`.

use crate::filter::{Counts, Filter};
use crate::head::SAMPLES;
use core::sync::atomic::{AtomicU32, Ordering};
use mk20dx_hal::clocks::McgExt;
use mk20dx_hal::pac::Peripherals;

/// From one orientation that is kept to the next, in samples.
pub const KEPT_EVERY: usize = 8;

/// w, x, y, z as of every eighth sample: the bits of doubles, the lower half first.
#[used]
static KEPT: [AtomicU32; 8 * SAMPLES / KEPT_EVERY] =
    [const { AtomicU32::new(0) }; 8 * SAMPLES / KEPT_EVERY];

/// 1 while a filter can be run, 2 when it has been.
#[used]
static STATE: AtomicU32 = AtomicU32::new(0);

/// Goes to 72 MHz and waits to be sent elsewhere.
pub fn wait() -> ! {
    if let Some(chip) = Peripherals::take() {
        chip.mcg.constrain().freeze(chip.osc, &chip.sim);
    }
    STATE.store(1, Ordering::Relaxed);
    loop {
        core::hint::spin_loop();
    }
}

/// The first sample by itself, all others by `update`.
pub fn run<F: Filter>(input: &[Counts], update: fn(&mut F, &Counts)) -> ! {
    let (mut filter, mut others) = (F::start(), input);
    if let Some(first) = others.split_off_first() {
        filter.update(first);
    }
    let mut kept = KEPT.chunks_exact(8);
    for (number, counts) in others.iter().enumerate() {
        update(&mut filter, counts);
        if (number + 2) % KEPT_EVERY == 0
            && let Some(words) = kept.next()
        {
            for (words, part) in words.chunks_exact(2).zip(filter.orientation()) {
                words[0].store(part.to_bits() as u32, Ordering::Relaxed);
                words[1].store((part.to_bits() >> 32) as u32, Ordering::Relaxed);
            }
        }
    }
    STATE.store(2, Ordering::Relaxed);
    loop {
        core::hint::spin_loop();
    }
}

/// A program that can run any of these filters: `name: Type, on so many of INPUT;`, with attributes for where its update
/// lies.
#[macro_export]
macro_rules! filters {
    ($($(#[$attribute:meta])* $name:ident: $filter:ty, on $samples:ident of $input:ident;)*) => {
        $(
            mod $name {
                use super::*;

                $(#[$attribute])*
                #[inline(never)]
                pub fn update(filter: &mut $filter, counts: &$crate::filter::Counts) {
                    $crate::filter::Filter::update(filter, counts);
                }

                #[inline(never)]
                pub extern "C" fn run() -> ! {
                    $crate::run::run(&$input[..$samples], update)
                }
            }
        )*

        /// Nothing calls them from here.
        #[used]
        static FILTERS: &[extern "C" fn() -> !] = &[$($name::run),*];

        #[cortex_m_rt::entry]
        fn main() -> ! {
            $crate::run::wait()
        }
    };
}
