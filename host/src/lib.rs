//! The PC's side of the tracker: finds the board or starts the emulated one, shows it, records it and
//! explains what is wrong.
//!
//! ```text
//!           ┌ port ─────┐
//! source ◄──┼ emulated ─┼──bytes──► stream ──samples──► hub ──► page, terminal, recording, …
//!           └ replay ───┘
//! ```
//!
//! The modules in the order of that path, then the commands that stand at its end.

pub mod failure;

pub mod patience;

pub mod output;

pub mod source;

pub mod stream;

pub mod hub;

pub mod board;

pub mod computer;

pub mod recording;

pub mod web;

pub mod interrupt;

#[cfg(feature = "tui")]
pub mod tui;

pub mod arguments;

pub mod commands;

pub mod cli;
