//! What can be done with a run: repeat it, stop it, look into it, write it down.

#[path = "runs/tracker.rs"]
mod tracker;

#[path = "runs/determinism.rs"]
mod determinism;

#[path = "runs/snapshot.rs"]
mod snapshot;

#[path = "runs/trace.rs"]
mod trace;

#[path = "runs/analyser.rs"]
mod analyser;

#[path = "runs/gdb.rs"]
mod gdb;

#[path = "runs/command.rs"]
mod command;
