//! The built-in host's driver: configures any device, opens its serial port if it has one, and reads it as Linux's
//! cdc_acm does.

use std::collections::VecDeque;

use super::bus::{Bus, Event};
use super::descriptors::{Endpoint, Kind};
use super::enumeration::Profile;
use super::transfer::{Outcome, Request, Ticket, Transfer};

/// CDC's communication and data interfaces (CDC 1.2, 4.2 and 4.5).
const COMMUNICATION: u8 = 0x02;
const DATA: u8 = 0x0A;
/// 115200 bit/s, 8N1 (PSTN 1.2, 6.3.10).
const LINE_CODING: [u8; 7] = [0, 0xC2, 1, 0, 0, 0, 8];
/// SET_CONTROL_LINE_STATE: DTR and RTS.
const PRESENT: u16 = 3;
/// Bytes to send in one transfer.
const CHUNK: usize = 64;

/// A request that is on its way, and whose it is.
#[derive(Debug, Clone)]
struct Asked {
    ticket: Ticket,
    request: Request,
    /// Whether somebody outside waits for the outcome.
    reported: bool,
}

/// The driver.
#[derive(Debug, Clone)]
pub(super) struct SerialPort {
    /// Requests of the driver's own, to be done in turn before anything else.
    set_up: VecDeque<Request>,
    requests: VecDeque<Request>,
    asked: Option<Asked>,
    outcomes: Vec<(Request, Outcome)>,
    configured: bool,
    bulk_in: Option<Endpoint>,
    bulk_out: Option<Endpoint>,
    /// Interrupt endpoints to be polled: a serial port's notifications, or whatever another device has.
    polled: Vec<(Endpoint, Option<Ticket>)>,
    reading: bool,
    read: Option<Ticket>,
    written: Option<(Ticket, usize)>,
    sending: VecDeque<u8>,
    received: Vec<u8>,
}

impl SerialPort {
    /// A driver without a device, which will read as soon as there is one.
    pub fn new() -> SerialPort {
        SerialPort {
            set_up: VecDeque::new(),
            requests: VecDeque::new(),
            asked: None,
            outcomes: Vec::new(),
            configured: false,
            bulk_in: None,
            bulk_out: None,
            polled: Vec::new(),
            reading: true,
            read: None,
            written: None,
            sending: VecDeque::new(),
            received: Vec::new(),
        }
    }

    /// Whether the device is configured and its port is open.
    pub fn is_open(&self) -> bool {
        self.configured && self.set_up.is_empty() && self.bulk_in.is_some()
    }

    /// Takes what the port has delivered.
    pub fn take_received(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.received)
    }

    /// Writes to the port.
    pub fn send(&mut self, bytes: &[u8]) {
        self.sending.extend(bytes);
    }

    /// Whether the port is read; packets that are not stay with the device.
    pub fn set_reading(&mut self, reading: bool) {
        self.reading = reading;
    }

    /// Queues a request.
    pub fn request(&mut self, request: Request) {
        self.requests.push_back(request);
    }

    /// Takes how the queued requests ended.
    pub fn take_outcomes(&mut self) -> Vec<(Request, Outcome)> {
        std::mem::take(&mut self.outcomes)
    }

    /// Begins to use a device that has an address.
    pub fn start(&mut self, profile: &Profile, bus: &Bus) {
        let value = profile.configuration_value();
        self.set_up
            .push_back(Request::write(0x00, 9, u16::from(value), 0, &[]));
        let known = bus
            .configurations()
            .iter()
            .find(|known| known.value == value);
        let endpoints = known
            .map(|known| known.endpoints.as_slice())
            .unwrap_or_default();
        let endpoints = || {
            endpoints
                .iter()
                .copied()
                .filter(|endpoint| endpoint.alternate == 0)
        };
        let bulk = |is_in| {
            endpoints().find(|endpoint| {
                (endpoint.class, endpoint.kind, endpoint.is_in()) == (DATA, Kind::Bulk, is_in)
            })
        };
        self.polled = endpoints()
            .filter(|endpoint| endpoint.kind == Kind::Interrupt && endpoint.is_in())
            .map(|endpoint| (endpoint, None))
            .collect();
        let interfaces = known
            .map(|known| known.interfaces.as_slice())
            .unwrap_or_default();
        let control = interfaces
            .iter()
            .find(|known| known.class[0] == COMMUNICATION);
        if let (Some(bulk_in), Some(bulk_out), Some(control)) = (bulk(true), bulk(false), control) {
            let control = u16::from(control.number);
            self.set_up
                .push_back(Request::write(0x21, 0x20, 0, control, &LINE_CODING));
            self.set_up
                .push_back(Request::write(0x21, 0x22, PRESENT, control, &[]));
            (self.bulk_in, self.bulk_out) = (Some(bulk_in), Some(bulk_out));
        }
    }

    /// The device is gone, and what was meant for it.
    pub fn stop(&mut self) {
        *self = SerialPort {
            reading: self.reading,
            outcomes: std::mem::take(&mut self.outcomes),
            received: std::mem::take(&mut self.received),
            ..SerialPort::new()
        };
    }

    /// Takes part in what happens on the bus.
    pub fn handle(&mut self, event: Event) {
        let Event::Ended(ticket, outcome) = event else {
            return;
        };
        if let Some(asked) = self.asked.take_if(|asked| asked.ticket == ticket) {
            if asked.reported {
                self.outcomes.push((asked.request, outcome));
            } else {
                self.set_up.pop_front();
                self.configured = true;
            }
        } else if self.read == Some(ticket) {
            self.read = None;
            match (outcome, self.bulk_in) {
                (Outcome::Done(data), _) => self.received.extend(data),
                (Outcome::Stalled, Some(endpoint)) => self.clear_halt(endpoint),
                _ => {}
            }
        } else if let Some((_, count)) = self.written.take_if(|(sent, _)| *sent == ticket) {
            match (outcome, self.bulk_out) {
                (Outcome::Done(_), _) => drop(self.sending.drain(..count)),
                (Outcome::Stalled, Some(endpoint)) => self.clear_halt(endpoint),
                _ => {}
            }
        } else {
            let polled = self
                .polled
                .iter_mut()
                .find(|(_, poll)| *poll == Some(ticket));
            if let Some((_, poll)) = polled {
                *poll = None;
            }
        }
    }

    fn clear_halt(&mut self, endpoint: Endpoint) {
        self.set_up
            .push_back(Request::write(0x02, 1, 0, u16::from(endpoint.address), &[]));
    }

    /// Keeps the bus busy with whatever is to be done.
    pub fn go_on(&mut self, bus: &mut Bus) {
        if self.asked.is_none() {
            let own = self.set_up.front().cloned();
            let reported = own.is_none();
            let other = || self.configured.then(|| self.requests.pop_front()).flatten();
            self.asked = own.or_else(other).map(|request| Asked {
                ticket: bus.submit(Transfer::Control(request.clone())),
                request,
                reported,
            });
        }
        if !self.configured || !self.set_up.is_empty() {
            return;
        }
        for (endpoint, poll) in &mut self.polled {
            let (number, length) = (endpoint.number(), endpoint.packet);
            poll.get_or_insert_with(|| bus.submit(Transfer::In { number, length }));
        }
        if let Some(endpoint) = self.bulk_in {
            // One packet at a time, so that each is delivered at once.
            let (number, length) = (endpoint.number(), endpoint.packet);
            if self.reading {
                self.read
                    .get_or_insert_with(|| bus.submit(Transfer::In { number, length }));
            } else if let Some(read) = self.read.take() {
                bus.cancel(read);
            }
        }
        if let Some(endpoint) = self.bulk_out.filter(|_| !self.sending.is_empty()) {
            let (number, closed) = (endpoint.number(), false);
            self.written.get_or_insert_with(|| {
                let data: Vec<u8> = self.sending.iter().copied().take(CHUNK).collect();
                let count = data.len();
                (
                    bus.submit(Transfer::Out {
                        number,
                        data,
                        closed,
                    }),
                    count,
                )
            });
        }
    }
}
