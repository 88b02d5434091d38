//! Asks the board to go into its loader, as PJRC's own tools do: a port opened at 134 baud.

use std::thread;
use std::time::Duration;

use crate::failure::Failure;
use crate::source::port;

/// The speed that means it.
const BAUD: u32 = 134;

/// The board leaves 15 frames after it has heard it, and its port with it.
const LEAVING: Duration = Duration::from_millis(250);

/// Asks it.
///
/// # Errors
///
/// The port cannot be had.
pub fn into_loader(name: &str) -> Result<(), Failure> {
    let port = port::open_at(name, BAUD)?;
    thread::sleep(LEAVING);
    drop(port);
    Ok(())
}
