//! How a PC gets to know a serial port: the requests of a Linux host and its cdc_acm driver, in their order, including
//! the one (device qualifier) that a full-speed device has to refuse.

use super::Identity;
use super::control::{Outcome, Request};

/// The address the host gives out.
const ADDRESS: u8 = 5;

const DEVICE: u16 = 0x0100;
const CONFIGURATION: u16 = 0x0200;
const STRING: u16 = 0x0300;
const QUALIFIER: u16 = 0x0600;
const ENGLISH: u16 = 0x0409;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    FirstDescriptor,
    SetAddress,
    DeviceDescriptor,
    Qualifier,
    ConfigurationHeader,
    Configuration,
    Languages,
    Manufacturer,
    Product,
    SerialNumber,
    SetConfiguration,
    LineCoding,
    LineState,
    Done,
}

/// What has to happen after a request.
pub(super) enum Next {
    Go,
    ResetBus,
    UseAddress(u8),
    Done,
}

/// What enumeration found.
#[derive(Debug, Clone, Default)]
pub(super) struct Found {
    pub identity: Identity,
    pub bulk_in: u8,
    pub bulk_out: u8,
    pub notifications: u8,
    control_interface: u8,
    string_indices: [u8; 3],
    configuration_length: u16,
    configuration_value: u8,
}

/// An enumeration on its way.
#[derive(Debug, Clone)]
pub(super) struct Enumeration {
    step: Step,
    found: Found,
}

impl Enumeration {
    pub(super) fn new() -> Enumeration {
        Enumeration {
            step: Step::FirstDescriptor,
            found: Found::default(),
        }
    }

    pub(super) fn found(self) -> Found {
        self.found
    }

    /// The request that is due.
    pub(super) fn request(&self) -> Option<Request> {
        let string = |n: usize| {
            Request::read(
                0x80,
                6,
                STRING | u16::from(self.found.string_indices[n]),
                ENGLISH,
                255,
            )
        };
        Some(match self.step {
            Step::FirstDescriptor => Request::read(0x80, 6, DEVICE, 0, 64),
            Step::SetAddress => Request::write(0x00, 5, u16::from(ADDRESS), 0, &[]),
            Step::DeviceDescriptor => Request::read(0x80, 6, DEVICE, 0, 18),
            Step::Qualifier => Request::read(0x80, 6, QUALIFIER, 0, 10),
            Step::ConfigurationHeader => Request::read(0x80, 6, CONFIGURATION, 0, 9),
            Step::Configuration => {
                Request::read(0x80, 6, CONFIGURATION, 0, self.found.configuration_length)
            }
            Step::Languages => Request::read(0x80, 6, STRING, 0, 255),
            Step::Manufacturer => string(0),
            Step::Product => string(1),
            Step::SerialNumber => string(2),
            Step::SetConfiguration => {
                Request::write(0x00, 9, u16::from(self.found.configuration_value), 0, &[])
            }
            Step::LineCoding => {
                // 115200 8N1
                Request::write(
                    0x21,
                    0x20,
                    0,
                    u16::from(self.found.control_interface),
                    &[0, 0xC2, 1, 0, 0, 0, 8],
                )
            }
            Step::LineState => {
                Request::write(0x21, 0x22, 3, u16::from(self.found.control_interface), &[])
            }
            Step::Done => return None,
        })
    }

    /// Takes in how the request ended; an error is what a PC's log would say.
    pub(super) fn ended(&mut self, outcome: Outcome) -> Result<Next, String> {
        let step = self.step;
        let data = match (outcome, step) {
            (Outcome::Stalled, Step::Qualifier) => Vec::new(),
            (Outcome::Done(_), Step::Qualifier) => {
                return Err("a full-speed device answered the device qualifier request".into());
            }
            (Outcome::Done(data), _) => data,
            (Outcome::Stalled, _) => return Err(format!("{step:?} was stalled")),
            (Outcome::Failed(why), _) => return Err(format!("{step:?}: {why}")),
        };
        let short = || format!("{step:?} answered only {} bytes", data.len());
        let (next, then) = match step {
            Step::FirstDescriptor => {
                if data.len() < 8 {
                    return Err(short());
                }
                (Step::SetAddress, Next::ResetBus)
            }
            Step::SetAddress => (Step::DeviceDescriptor, Next::UseAddress(ADDRESS)),
            Step::DeviceDescriptor => {
                let device: &[u8; 18] = data.as_slice().try_into().map_err(|_| short())?;
                self.found.identity.vendor = u16::from_le_bytes([device[8], device[9]]);
                self.found.identity.product = u16::from_le_bytes([device[10], device[11]]);
                self.found.string_indices = [device[14], device[15], device[16]];
                (Step::Qualifier, Next::Go)
            }
            Step::Qualifier => (Step::ConfigurationHeader, Next::Go),
            Step::ConfigurationHeader => {
                let header: &[u8; 9] = data.as_slice().try_into().map_err(|_| short())?;
                self.found.configuration_length = u16::from_le_bytes([header[2], header[3]]);
                self.found.configuration_value = header[5];
                (Step::Configuration, Next::Go)
            }
            Step::Configuration => {
                if data.len() != usize::from(self.found.configuration_length) {
                    return Err(short());
                }
                self.read_configuration(&data)?;
                (Step::Languages, Next::Go)
            }
            Step::Languages => (Step::Manufacturer, Next::Go),
            Step::Manufacturer => {
                self.found.identity.manufacturer = string(&data)?;
                (Step::Product, Next::Go)
            }
            Step::Product => {
                self.found.identity.product_name = string(&data)?;
                (Step::SerialNumber, Next::Go)
            }
            Step::SerialNumber => {
                self.found.identity.serial_number = string(&data)?;
                (Step::SetConfiguration, Next::Go)
            }
            Step::SetConfiguration => (Step::LineCoding, Next::Go),
            Step::LineCoding => (Step::LineState, Next::Go),
            Step::LineState | Step::Done => (Step::Done, Next::Done),
        };
        self.step = next;
        Ok(then)
    }

    /// Finds the serial port's endpoints.
    fn read_configuration(&mut self, mut rest: &[u8]) -> Result<(), String> {
        let (mut class, mut number) = (0, 0);
        while let [length, kind, ..] = *rest {
            let Some(descriptor) = rest.get(..usize::from(length)).filter(|_| length >= 2) else {
                return Err("a descriptor in the configuration has an impossible length".into());
            };
            match (kind, descriptor) {
                (4, [_, _, interface, _, _, interface_class, ..]) => {
                    (class, number) = (*interface_class, *interface);
                    if class == 0x02 {
                        self.found.control_interface = number;
                    }
                }
                (5, [_, _, address, attributes, ..]) => {
                    match (class, attributes & 3, address & 0x80 != 0) {
                        (0x0A, 2, true) => self.found.bulk_in = address & 0xF,
                        (0x0A, 2, false) => self.found.bulk_out = address & 0xF,
                        (0x02, 3, true) => self.found.notifications = address & 0xF,
                        _ => {
                            return Err(format!(
                                "endpoint {address:#04x} of interface {number} fits no serial port"
                            ));
                        }
                    }
                }
                _ => {}
            }
            rest = &rest[usize::from(length)..];
        }
        if self.found.bulk_in == 0 || self.found.bulk_out == 0 {
            return Err("the configuration holds no CDC serial port".into());
        }
        Ok(())
    }
}

fn string(descriptor: &[u8]) -> Result<String, String> {
    match descriptor {
        [length, 3, text @ ..] if usize::from(*length) == descriptor.len() => {
            let units: Vec<u16> = text
                .chunks_exact(2)
                .map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
                .collect();
            Ok(String::from_utf16_lossy(&units))
        }
        _ => Err("a malformed string descriptor".into()),
    }
}
