//! What `vrduino` can do, a file each: its arguments, and what it does with them.

pub mod view;

#[cfg(feature = "tui")]
pub mod tui;

pub mod serve;

pub mod list;

pub mod monitor;

pub mod record;

pub mod replay;

#[cfg(feature = "plot")]
pub mod plot;

pub mod calibrate;

pub mod flash;

pub mod doctor;
