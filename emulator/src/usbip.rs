//! The emulated device for another host: USB/IP 1.1.1 on a loopback port.
//!
//! A stock Linux kernel attaches it (`usbip attach -r 127.0.0.1 -b 1-1`) and uses it as if it were plugged in. Its
//! transfers go to the emulated bus, so the firmware answers every request itself. What USB/IP does not carry (reset,
//! SET_ADDRESS, frames, toggles, packets) is [`crate::host`]'s business.
//!
//! ```text
//! TCP ──► server, connection: who has the device ──► session: transfers by number ──► host
//!                     protocol: bytes ◄──► messages
//! ```

mod connection;

mod protocol;

mod server;

mod session;

pub use server::{BUS_ID, Server};
