//! The way into the board's loader without pressing its button.
//!
//! PJRC's tools and the Arduino environment ask for it by setting the serial port to 134 baud, which no
//! modem ever used. Teensyduino answers after 15 ms, so that the request can be acknowledged, with a
//! breakpoint: the loader chip on the board is a debugger, sees the halt, and takes over.

/// The speed that asks for the loader.
pub const BAUD: u32 = 134;
/// Teensyduino's wait, in milliseconds.
const WAIT_MS: u32 = 15;

/// A request for the loader.
#[derive(Default)]
pub struct Loader {
    asked_at: Option<u32>,
}

impl Loader {
    /// Hands the board over once a request is old enough. `now` is in milliseconds.
    pub fn serve(&mut self, asked: bool, now: u32) {
        if asked {
            self.asked_at.get_or_insert(now);
        }
        if self
            .asked_at
            .is_some_and(|since| now.wrapping_sub(since) >= WAIT_MS)
        {
            cortex_m::asm::bkpt();
        }
    }
}
