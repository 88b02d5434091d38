//! Reset control module (K20 manual, chapter 15): why the chip was last reset.

/// What reset the chip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Power was applied.
    PowerOn,
    /// The watchdog.
    Watchdog,
    /// A fault within a fault.
    Lockup,
    /// The program asked for it (SYSRESETREQ).
    Software,
}

/// The reset control module.
#[derive(Debug, Clone)]
pub struct ResetControl {
    cause: Cause,
}

impl ResetControl {
    /// The state after a reset for `cause`.
    pub fn new(cause: Cause) -> ResetControl {
        ResetControl { cause }
    }

    /// Reads an 8-bit register: SRS0 at 0, SRS1 at 1.
    pub fn read(&self, offset: u32) -> u32 {
        match (offset, self.cause) {
            (0, Cause::PowerOn) => 0x82,
            (0, Cause::Watchdog) => 0x20,
            (1, Cause::Lockup) => 0x02,
            (1, Cause::Software) => 0x04,
            _ => 0,
        }
    }
}
