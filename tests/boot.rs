//! The very image that is flashed, booted on the emulated board.
//!
//! The emulator shares no code with the firmware, so what these tests see on the emulated serial port
//! has gone through two independent readings of the manuals.

#[path = "boot/run.rs"]
mod run;

#[path = "boot/turns.rs"]
mod turns;

#[path = "boot/recordings.rs"]
mod recordings;

#[path = "boot/host.rs"]
mod host;

#[path = "boot/faults.rs"]
mod faults;

#[path = "boot/magnetometer.rs"]
mod magnetometer;

#[path = "boot/store.rs"]
mod store;

#[path = "boot/sampling.rs"]
mod sampling;
#[path = "boot/streams.rs"]
mod streams;
