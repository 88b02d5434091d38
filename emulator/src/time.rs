//! Emulated time: one unit that every clock on the board divides evenly.

/// A moment or a span, in ticks of 1/144 MHz.
///
/// 144 MHz is a common multiple of everything derived from the crystal: the 72 MHz core (2 ticks a cycle), the
/// 36 MHz bus (4), the 24 MHz flash (6), the 48 MHz USB clock (3) and USB's 12 Mbit/s (12 ticks a bit).
pub type Ticks = u64;

/// Ticks in a second.
pub const SECOND: Ticks = 144_000_000;

/// Ticks in a millisecond, which is also one USB frame.
pub const MILLISECOND: Ticks = SECOND / 1_000;

/// Ticks in a microsecond.
pub const MICROSECOND: Ticks = SECOND / 1_000_000;

/// The time that lies so far ahead that it never comes.
pub const NEVER: Ticks = Ticks::MAX;

/// `ticks` in seconds.
pub fn seconds(ticks: Ticks) -> f64 {
    ticks as f64 / SECOND as f64
}

/// `seconds` in ticks, rounded to the nearest; negative or absurd values are clamped.
pub fn ticks(seconds: f64) -> Ticks {
    (seconds * SECOND as f64).round() as Ticks
}

/// How long `cycles` of a clock of `hz` take, rounded up.
pub fn of_cycles(cycles: u64, hz: u32) -> Ticks {
    (u128::from(cycles) * u128::from(SECOND)).div_ceil(u128::from(hz.max(1))) as Ticks
}
