//! How a PC gets to know a device: the requests of a Linux host in their order, including the one (device qualifier)
//! that a full-speed device has to refuse.

use super::Identity;
use super::descriptors::{Configuration, Interface, string};
use super::transfer::{Outcome, Request};

/// The address the host gives out.
pub(super) const ADDRESS: u8 = 5;

const DEVICE: u16 = 0x0100;
const CONFIGURATION: u16 = 0x0200;
const STRING: u16 = 0x0300;
const QUALIFIER: u16 = 0x0600;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    FirstDescriptor,
    SetAddress,
    DeviceDescriptor,
    Qualifier,
    ConfigurationHeader,
    Configuration,
    Languages,
    /// The manufacturer, the product, the serial number.
    String(usize),
    Done,
}

/// What has to happen after a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Next {
    Go,
    ResetBus,
    Done,
}

/// What enumeration found.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Profile {
    /// What the device calls itself.
    pub identity: Identity,
    /// The device descriptor.
    pub device: Vec<u8>,
    /// The first configuration descriptor with all that belongs to it.
    pub configuration: Vec<u8>,
}

impl Profile {
    /// bConfigurationValue.
    pub fn configuration_value(&self) -> u8 {
        self.configuration.get(5).copied().unwrap_or(0)
    }

    /// The configuration's interfaces.
    pub fn interfaces(&self) -> Vec<Interface> {
        Configuration::parse(&self.configuration)
            .map(|found| found.interfaces)
            .unwrap_or_default()
    }
}

/// An enumeration on its way.
#[derive(Debug, Clone)]
pub(super) struct Enumeration {
    step: Step,
    found: Profile,
    configuration_length: u16,
    language: u16,
}

impl Enumeration {
    pub fn new() -> Enumeration {
        Enumeration {
            step: Step::FirstDescriptor,
            found: Profile::default(),
            configuration_length: 0,
            language: 0,
        }
    }

    pub fn found(self) -> Profile {
        self.found
    }

    /// The request that is due.
    pub fn request(&self) -> Option<Request> {
        let descriptor = |value, index, length| Request::read(0x80, 6, value, index, length);
        Some(match self.step {
            Step::FirstDescriptor => descriptor(DEVICE, 0, 64),
            Step::SetAddress => Request::write(0x00, 5, u16::from(ADDRESS), 0, &[]),
            Step::DeviceDescriptor => descriptor(DEVICE, 0, 18),
            Step::Qualifier => descriptor(QUALIFIER, 0, 10),
            Step::ConfigurationHeader => descriptor(CONFIGURATION, 0, 9),
            Step::Configuration => descriptor(CONFIGURATION, 0, self.configuration_length),
            Step::Languages => descriptor(STRING, 0, 255),
            Step::String(n) => {
                let index = self.found.device[14 + n];
                descriptor(STRING | u16::from(index), self.language, 255)
            }
            Step::Done => return None,
        })
    }

    /// Takes in how the request ended; an error is what a PC's log would say.
    pub fn ended(&mut self, outcome: Outcome) -> Result<Next, String> {
        let step = self.step;
        let data = match (outcome, step) {
            (Outcome::Done(data), _) => data,
            // Neither a qualifier nor strings are a device's duty.
            (Outcome::Stalled, Step::Qualifier | Step::Languages | Step::String(_)) => Vec::new(),
            (Outcome::Stalled, _) => return Err(format!("{step:?} was stalled")),
            (Outcome::Failed(why), _) => return Err(format!("{step:?}: {why}")),
        };
        let short = || format!("{step:?} answered only {} bytes", data.len());
        let mut then = Next::Go;
        self.step = match step {
            Step::FirstDescriptor => {
                if data.len() < 8 {
                    return Err(short());
                }
                then = Next::ResetBus;
                Step::SetAddress
            }
            Step::SetAddress => Step::DeviceDescriptor,
            Step::DeviceDescriptor => {
                let device: &[u8; 18] = data.as_slice().try_into().map_err(|_| short())?;
                self.found.identity.vendor = u16::from_le_bytes([device[8], device[9]]);
                self.found.identity.product = u16::from_le_bytes([device[10], device[11]]);
                self.found.device = data;
                Step::Qualifier
            }
            Step::Qualifier => Step::ConfigurationHeader,
            Step::ConfigurationHeader => {
                let header: &[u8; 9] = data.as_slice().try_into().map_err(|_| short())?;
                self.configuration_length = u16::from_le_bytes([header[2], header[3]]);
                Step::Configuration
            }
            Step::Configuration => {
                if data.len() != usize::from(self.configuration_length) {
                    return Err(short());
                }
                self.found.configuration = data;
                if self.found.device[14..17] == [0; 3] {
                    Step::Done
                } else {
                    Step::Languages
                }
            }
            Step::Languages => match data[..] {
                [_, 3, low, high, ..] => {
                    self.language = u16::from_le_bytes([low, high]);
                    self.next_string(0)
                }
                _ => Step::Done,
            },
            Step::String(n) => {
                let identity = &mut self.found.identity;
                let text = [
                    &mut identity.manufacturer,
                    &mut identity.product_name,
                    &mut identity.serial_number,
                ];
                if let Some(text) = text.into_iter().nth(n).filter(|_| !data.is_empty()) {
                    *text = string(&data)?;
                }
                self.next_string(n + 1)
            }
            Step::Done => Step::Done,
        };
        if self.step == Step::Done {
            then = Next::Done;
        }
        Ok(then)
    }

    /// The first string from the `n`th on that the device has.
    fn next_string(&self, n: usize) -> Step {
        (n..3)
            .find(|n| self.found.device[14 + n] != 0)
            .map_or(Step::Done, Step::String)
    }
}
