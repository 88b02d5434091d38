//! What requests do to the bus once the device has acknowledged them (USB 2.0, 9.4).

use super::{ADDRESS_RECOVERY, Bus, Event};
use crate::host::descriptors::Configuration;
use crate::host::pipe::Pipe;
use crate::host::transfer::{Failure, Outcome, Request};
use crate::host::wire::Wire;
use crate::witness::Trap;

const ENDPOINT_HALT: u16 = 0;
const DEVICE_REMOTE_WAKEUP: u16 = 1;

impl Bus {
    /// The device has carried `request` out, and answered `data`.
    pub(super) fn took_effect(&mut self, request: &Request, data: &[u8], wire: &mut Wire<'_>) {
        let (value, index) = (request.value(), request.index());
        match (request.setup[0], request.setup[1]) {
            (0x00, 0x05) => {
                self.address = value as u8 & 0x7F;
                self.control.fresh_address = self.address != 0;
                self.control.ready_at = wire.now + ADDRESS_RECOVERY;
            }
            (0x00, 0x09) => self.open_pipes(|_| true, value as u8, 0),
            (0x01, 0x0B) => {
                let active = self.configuration;
                let interface = index as u8;
                self.open_pipes(|number| number == interface, active, value as u8);
            }
            (0x02, feature @ (0x01 | 0x03)) if value == ENDPOINT_HALT => {
                match self.pipe(index as u8) {
                    Some(pipe) if feature == 0x01 => pipe.restart(),
                    Some(pipe) => pipe.halted = true,
                    None => {}
                }
            }
            (0x00, feature @ (0x01 | 0x03)) if value == DEVICE_REMOTE_WAKEUP => {
                self.wake_up_enabled = feature == 0x03;
            }
            (0x80, 0x06) => self.learn((value >> 8) as u8, data, wire),
            _ => {}
        }
    }

    /// Closes the pipes of the chosen interfaces and opens those of their setting `alternate`, with DATA0 (9.1.1.5).
    fn open_pipes(&mut self, chosen: impl Fn(u8) -> bool, configuration: u8, alternate: u8) {
        for mut pipe in self
            .pipes
            .extract_if(.., |pipe| chosen(pipe.endpoint.interface))
        {
            for ticket in pipe.clear() {
                let outcome = Outcome::Failed(Failure::Gone);
                self.events.push_back(Event::Ended(ticket, outcome));
            }
        }
        self.configuration = configuration;
        let known = self
            .configurations
            .iter()
            .find(|known| known.value == configuration);
        let endpoints = known
            .map(|known| known.endpoints.as_slice())
            .unwrap_or_default();
        let opened = endpoints
            .iter()
            .filter(|endpoint| chosen(endpoint.interface) && endpoint.alternate == alternate);
        self.pipes.extend(opened.copied().map(Pipe::new));
    }

    /// Takes in a descriptor that passes.
    fn learn(&mut self, kind: u8, data: &[u8], wire: &mut Wire<'_>) {
        let wrong = match (kind, data) {
            (1, [_, _, _, _, _, _, _, packet @ (8 | 16 | 32 | 64), ..]) => {
                self.control.packet = usize::from(*packet);
                None
            }
            (1, [_, _, _, _, _, _, _, packet, ..]) => Some(format!(
                "bMaxPacketSize0 is {packet}; full speed allows 8, 16, 32 and 64"
            )),
            // A host may ask for less than the whole.
            (2, [_, _, low, high, ..])
                if data.len() >= usize::from(u16::from_le_bytes([*low, *high])) =>
            {
                match Configuration::parse(data) {
                    Ok(found) => {
                        self.configurations
                            .retain(|known| known.value != found.value);
                        self.configurations.push(found);
                        None
                    }
                    Err(why) => Some(why),
                }
            }
            // No full-speed device has one (9.6.2).
            (6, _) => Some("a full-speed device answered the device qualifier request".to_owned()),
            _ => None,
        };
        if let Some(why) = wrong {
            wire.witness.saw(Trap::UsbDescriptor, why);
        }
    }
}
