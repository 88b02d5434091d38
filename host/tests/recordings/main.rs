//! Promise: what came is in the file, what is in the file can be seen again, and a file that is not as it
//! should be says what is wrong with it.

mod fixture;

mod files;

#[cfg(unix)]
mod interrupted;

#[cfg(feature = "parquet")]
mod parquet;

#[cfg(feature = "plot")]
mod pictures;

#[path = "../program/mod.rs"]
mod program;

#[cfg(unix)]
#[path = "../pty/mod.rs"]
mod pty;

mod recorded;

mod replayed;
