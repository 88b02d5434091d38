//! What the wrong images share: registers by address, and the way to a running chip.
//!
//! Each image in `src/bin` is a few lines that break one rule; its name is the name of the trap. The emulator's test
//! `traps` boots every one of them, and expects it to be stopped by that trap and no other.

#![no_std]

pub mod chip;

pub mod flash;

pub mod registers;

#[cfg(target_os = "none")]
pub mod usb;

/// Defines an image: what it does when it has started.
///
/// With `reset: …` the image also says what happens at once after reset, before memory is initialised; otherwise the
/// watchdog is switched off there, as most programs do.
#[macro_export]
macro_rules! image {
    (reset: $reset:expr, main: $main:expr) => {
        // SAFETY: the start-up code calls this once, before memory is initialised; it uses none.
        #[unsafe(no_mangle)]
        extern "C" fn __pre_init() {
            $reset
        }

        #[cortex_m_rt::entry]
        fn main() -> ! {
            #[allow(clippy::no_effect)] // The watchdog's images have nothing left to do here.
            $main;
            $crate::chip::idle()
        }

        use panic_halt as _;
    };
    ($main:expr) => {
        $crate::image!(reset: $crate::chip::disable_watchdog(), main: $main);
    };
}
