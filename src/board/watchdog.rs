//! The watchdog (K20 manual, chapter 23): configured within the reset window, locked, and fed.
//!
//! The chip resets unless the watchdog is unlocked within 256 bus cycles of every reset, so this
//! happens in `__pre_init`, before RAM is initialised. It is then counted by the 1 kHz low-power
//! oscillator, which neither a clock switch nor sleep stops, and cannot be changed or switched off
//! until the next reset.

use core::arch::global_asm;

use mk20dx_hal::pac;

/// Longest time between two feedings, in milliseconds (periods of the oscillator, ±10 %).
///
/// The longest thing done between two is setting up the sensor, about 110 ms.
const TIMEOUT_MS: u16 = 500;

/// STCTRLH: enabled, counted by the LPO, no further update, running in wait and stop mode.
const STCTRLH: u16 = 0x01C1;

// In assembly, since no Rust code may run before RAM is initialised. The two unlock words follow each
// other within the 20 bus cycles allowed; the two idle instructions are the bus cycle that has to
// pass before the first change (23.3.1).
global_asm!(
    ".section .text.__pre_init, \"ax\"",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "ldr r0, =0x40052000",
    "movw r1, #0xC520",
    "movw r2, #0xD928",
    "movs r3, #0",
    "strh r1, [r0, #0x0E]", // UNLOCK
    "strh r2, [r0, #0x0E]",
    "nop",
    "nop",
    "strh r3, [r0, #0x16]", // PRESC: no division
    "strh r3, [r0, #0x04]", // TOVALH
    "movw r1, #{timeout}",
    "strh r1, [r0, #0x06]", // TOVALL
    "movw r1, #{stctrlh}",
    "strh r1, [r0, #0x00]", // STCTRLH
    "bx lr",
    ".ltorg",
    timeout = const TIMEOUT_MS,
    stctrlh = const STCTRLH,
);

/// The running watchdog.
pub struct Watchdog {
    registers: pac::Wdog,
}

impl Watchdog {
    /// Takes charge of the watchdog that `__pre_init` has configured.
    pub fn new(registers: pac::Wdog) -> Watchdog {
        Watchdog { registers }
    }

    /// Starts its count anew. To be called where the program has proved that it is alive, never from
    /// an interrupt: those go on after a panic.
    pub fn feed(&mut self) {
        let refresh = self.registers.refresh();
        // Both words have to come within 20 bus cycles.
        cortex_m::interrupt::free(|_| {
            // SAFETY: the first word of the refresh sequence (23.7.7).
            refresh.write(|w| unsafe { w.bits(0xA602) });
            // SAFETY: the second word of the refresh sequence.
            refresh.write(|w| unsafe { w.bits(0xB480) });
        });
    }
}
