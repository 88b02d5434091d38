//! Promise: what `vrduino view` and `vrduino serve` say to pages is what `docs/host-protocol.md` says they do,
//! it comes from the emulated board, and pages of other people's get nothing.

mod client;

mod course;

mod page;

#[path = "../program/mod.rs"]
mod program;

#[cfg(all(unix, feature = "tui"))]
#[path = "../pty/terminal.rs"]
mod pty;

#[path = "../program/server.rs"]
mod server;

mod strangers;

#[cfg(all(unix, feature = "tui"))]
mod terminal;
