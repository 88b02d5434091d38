//! The command line: the commands and their order.

use clap::{Parser, Subcommand};

use crate::commands::{calibrate, doctor, flash, list, monitor, record, replay, serve, view};
use crate::failure::Kind;

/// Shows, records and explains what a VRduino head tracker sends.
///
/// Without a board, --emulate boots the very image that is flashed in an emulator of the board; every command that
/// reads a board can read that one.
#[derive(Debug, Parser)]
#[command(name = "vrduino", version, after_help = Kind::MEANINGS, max_term_width = 100)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Opens a page in the browser that shows the board turn, in stereo too, with charts and controls
    View(view::Arguments),
    /// Shows the same in the terminal
    #[cfg(feature = "tui")]
    Tui(crate::commands::tui::Arguments),
    /// Takes the place of the course's server: the board's lines on ws://localhost:8081
    Serve(serve::Arguments),
    /// Lists the serial ports and which of them is a board
    List(list::Arguments),
    /// Prints how the stream goes: rate, delays, gaps, errors
    Monitor(monitor::Arguments),
    /// Writes the stream to a file
    Record(record::Arguments),
    /// Plays a recording, at the pace at which it came
    Replay(replay::Arguments),
    /// Draws a recording
    #[cfg(feature = "plot")]
    Plot(crate::commands::plot::Arguments),
    /// Finds out what is wrong with this sensor, and lets the board keep it
    Calibrate(calibrate::Arguments),
    /// Puts the tracker's program on the board
    Flash(flash::Arguments),
    /// Looks for what is wrong, and says what to do next
    Doctor(doctor::Arguments),
    /// Prints completions for a shell
    Completions {
        /// Which shell.
        shell: clap_complete::Shell,
    },
}
