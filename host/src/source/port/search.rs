//! Which of the serial ports is a board.

use serialport::{SerialPortType, UsbPortInfo};

use crate::failure::{Failure, Kind};

/// PJRC's vendor number, which the Teensy's programs share.
const VENDOR: u16 = 0x16C0;
/// A Teensy that is a serial port.
const SERIAL: u16 = 0x0483;
/// What the course's programs look for.
pub const MANUFACTURER: &str = "Teensyduino";

/// A serial port.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// What it is opened by.
    pub name: String,
    /// What the device behind it says of itself, if it is a USB device.
    pub usb: Option<UsbPortInfo>,
}

impl Found {
    /// What it says that made it.
    pub fn manufacturer(&self) -> Option<&str> {
        self.usb.as_ref()?.manufacturer.as_deref()
    }

    /// Whether it has a Teensy's numbers.
    pub fn is_board(&self) -> bool {
        self.usb
            .as_ref()
            .is_some_and(|usb| (usb.vid, usb.pid) == (VENDOR, SERIAL))
    }
}

/// All serial ports, by name.
///
/// # Errors
///
/// The system does not tell.
pub fn ports() -> Result<Vec<Found>, Failure> {
    let found = serialport::available_ports().map_err(|error| {
        let sentence =
            format!("the system does not list its serial ports: {error}; name one with --port");
        Failure::new(Kind::Computer, sentence)
    })?;
    let mut found: Vec<Found> = found
        .into_iter()
        .map(|port| Found {
            name: port.port_name,
            usb: match port.port_type {
                SerialPortType::UsbPort(usb) => Some(usb),
                _ => None,
            },
        })
        .collect();
    found.sort_by(|a, b| a.name.cmp(&b.name));
    // macOS has two names for each; the one that does not wait for a carrier will do.
    let dialling: Vec<String> = found.iter().map(|port| port.name.clone()).collect();
    found.retain(|port| {
        port.name
            .strip_prefix("/dev/tty.")
            .is_none_or(|rest| !dialling.contains(&format!("/dev/cu.{rest}")))
    });
    Ok(found)
}

/// Those that have a Teensy's numbers.
///
/// # Errors
///
/// As for [`ports`].
pub fn boards() -> Result<Vec<Found>, Failure> {
    let mut found = ports()?;
    found.retain(Found::is_board);
    Ok(found)
}

/// The one board there is.
///
/// # Errors
///
/// None, or several.
pub fn find() -> Result<Found, Failure> {
    let mut found = boards()?;
    match found.len() {
        0 => Err(Failure::new(
            Kind::Board,
            "no board is plugged in: connect it by USB, name its port with --port, or take --emulate for the emulated board (`vrduino doctor` looks closer)",
        )),
        1 => Ok(found.remove(0)),
        count => {
            let names: Vec<_> = found.iter().map(|port| port.name.as_str()).collect();
            Err(Failure::new(
                Kind::Board,
                format!(
                    "{count} boards are plugged in: choose one with --port {}",
                    names.join(" or --port ")
                ),
            ))
        }
    }
}
