//! A USB host on the other end of the cable: finds the device, enumerates it as a PC does, opens its serial port and
//! reads it, one transaction after the other in 1 ms frames.
//!
//! It judges as it goes: data toggles, packet sizes, answers that never come. What it objects to is in
//! [`Host::complaints`].

mod control;

mod enumeration;

use std::collections::VecDeque;

pub use control::{Outcome, Request};

use crate::cpu::Ram;
use crate::peripherals::usbotg::{Answer, Token, UsbController};
use crate::time::{MICROSECOND, MILLISECOND, NEVER, Ticks};
use control::Transfer;
use enumeration::Enumeration;

/// What the host learned about the device.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Identity {
    /// idVendor.
    pub vendor: u16,
    /// idProduct.
    pub product: u16,
    /// iManufacturer.
    pub manufacturer: String,
    /// iProduct.
    pub product_name: String,
    /// iSerialNumber.
    pub serial_number: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cable {
    /// Nothing shows on the bus; looked at again once a frame.
    Empty,
    /// A pull-up was seen; wait for the plug to settle (USB 2.0, 7.1.7.3: 100 ms).
    Settling(Ticks),
    /// SE0 on the bus, then silence for the device to recover.
    Resetting { recovered: Ticks },
    /// Frames run.
    Running,
}

/// A bulk or interrupt pipe.
#[derive(Debug, Clone, Copy, Default)]
struct Pipe {
    endpoint: u8,
    /// The toggle the host expects or sends next.
    toggle: bool,
    /// Not tried before this time: NAKed, or not due yet.
    ready_at: Ticks,
}

/// The host.
#[derive(Debug, Clone)]
pub struct Host {
    cable: Cable,
    plugged: bool,
    address: u8,
    frame: u16,
    next_frame: Ticks,
    bus_free_at: Ticks,
    frame_end_guard: Ticks,
    enumeration: Option<Enumeration>,
    transfer: Option<Transfer>,
    transfer_ready_at: Ticks,
    requests: VecDeque<Request>,
    outcomes: Vec<(Request, Outcome)>,
    bulk_in: Pipe,
    bulk_out: Pipe,
    notifications: Pipe,
    sending: VecDeque<u8>,
    received: Vec<u8>,
    reading: bool,
    identity: Option<Identity>,
    /// What a strict host objects to, in order.
    pub complaints: Vec<String>,
}

/// A NAKed bulk or control pipe is tried again after this time.
const RETRY: Ticks = 40 * MICROSECOND;
/// The host's drivers need a while before the next control transfer.
const BETWEEN_TRANSFERS: Ticks = 100 * MICROSECOND;
/// Largest packet at full speed on the endpoints of a serial port.
const MAX_PACKET: usize = 64;

impl Host {
    /// A host with the cable plugged in and its serial port to be opened and read.
    pub fn new() -> Host {
        Host {
            cable: Cable::Empty,
            plugged: true,
            address: 0,
            frame: 0,
            next_frame: 0,
            bus_free_at: 0,
            frame_end_guard: 0,
            enumeration: None,
            transfer: None,
            transfer_ready_at: 0,
            requests: VecDeque::new(),
            outcomes: Vec::new(),
            bulk_in: Pipe::default(),
            bulk_out: Pipe::default(),
            notifications: Pipe::default(),
            sending: VecDeque::new(),
            received: Vec::new(),
            reading: true,
            identity: None,
            complaints: Vec::new(),
        }
    }

    /// Whether the device is configured and its port is open.
    pub fn is_open(&self) -> bool {
        self.identity.is_some() && self.enumeration.is_none()
    }

    /// The device, once it was enumerated.
    pub fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Takes what the serial port has delivered.
    pub fn take_received(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.received)
    }

    /// Writes to the serial port.
    pub fn send(&mut self, bytes: &[u8]) {
        self.sending.extend(bytes);
    }

    /// Whether the host reads the port; one that stopped leaves the device's packets where they are.
    pub fn set_reading(&mut self, reading: bool) {
        self.reading = reading;
    }

    /// Resets the bus and enumerates anew, as a PC does when a driver asks for it.
    pub fn reset_bus(&mut self) {
        if self.cable == Cable::Running {
            self.cable = Cable::Settling(0);
        }
    }

    /// Pulls the plug or puts it back.
    pub fn set_plugged(&mut self, plugged: bool) {
        self.plugged = plugged;
    }

    /// Queues a control request for after enumeration.
    pub fn request(&mut self, request: Request) {
        self.requests.push_back(request);
    }

    /// Takes how the queued requests ended.
    pub fn take_outcomes(&mut self) -> Vec<(Request, Outcome)> {
        std::mem::take(&mut self.outcomes)
    }

    /// When [`Host::advance`] has to be called next.
    pub fn next_event(&self) -> Ticks {
        match self.cable {
            Cable::Empty => self.next_frame,
            Cable::Settling(until) => until,
            Cable::Resetting { recovered } => recovered.min(self.next_frame),
            Cable::Running => self.next_frame.min(self.next_transaction()),
        }
    }

    fn next_transaction(&self) -> Ticks {
        let mut at = NEVER;
        if self.transfer.is_some() || self.enumeration.is_some() || !self.requests.is_empty() {
            at = at.min(self.transfer_ready_at);
        }
        if self.is_open() {
            if self.reading {
                at = at.min(self.bulk_in.ready_at);
            }
            if !self.sending.is_empty() {
                at = at.min(self.bulk_out.ready_at);
            }
            at = at.min(self.notifications.ready_at);
        }
        if at == NEVER {
            NEVER
        } else {
            at.max(self.bus_free_at)
        }
    }

    /// Does what is due at `now`. `clocked` tells whether the device's USB module has its 48 MHz.
    pub fn advance(&mut self, now: Ticks, clocked: bool, device: &mut UsbController, ram: &Ram) {
        let attached = self.plugged && clocked && device.pulled_up();
        if !attached && self.cable != Cable::Empty {
            self.detach(now);
        }
        match self.cable {
            Cable::Empty => {
                self.next_frame = now + MILLISECOND;
                if attached {
                    self.cable = Cable::Settling(now + 100 * MILLISECOND);
                }
            }
            Cable::Settling(until) if now >= until => {
                self.forget_device();
                self.enumeration = Some(Enumeration::new());
                self.drive_reset(now, device);
            }
            Cable::Resetting { recovered } if now >= recovered => {
                self.cable = Cable::Running;
                self.next_frame = now;
                self.transfer_ready_at = now;
            }
            Cable::Running => {
                if now >= self.next_frame {
                    self.frame = self.frame.wrapping_add(1);
                    device.start_of_frame(self.frame);
                    self.bus_free_at = now + 4 * MICROSECOND;
                    self.next_frame = now + MILLISECOND;
                    self.frame_end_guard = self.next_frame - 70 * MICROSECOND;
                }
                if now >= self.next_transaction() {
                    if now < self.frame_end_guard {
                        self.transact(now, device, ram);
                    } else {
                        // Too late in this frame for another packet.
                        self.bus_free_at = self.next_frame;
                    }
                }
            }
            _ => {}
        }
    }

    fn detach(&mut self, now: Ticks) {
        self.forget_device();
        self.enumeration = None;
        self.cable = Cable::Empty;
        self.next_frame = now + MILLISECOND;
    }

    fn forget_device(&mut self) {
        self.identity = None;
        self.transfer = None;
        self.requests.clear();
        self.sending.clear();
        self.address = 0;
    }

    fn drive_reset(&mut self, now: Ticks, device: &mut UsbController) {
        device.bus_reset();
        self.address = 0;
        self.cable = Cable::Resetting {
            recovered: now + 20 * MILLISECOND,
        };
        self.next_frame = NEVER;
    }

    /// One transaction of the most urgent pipe: notifications, then control, then bulk in turn.
    fn transact(&mut self, now: Ticks, device: &mut UsbController, ram: &Ram) {
        let control_due = self.transfer_ready_at <= now
            && (self.transfer.is_some() || self.enumeration.is_some() || !self.requests.is_empty());
        let bytes = if self.is_open() && self.notifications.ready_at <= now {
            self.poll_notifications(now, device, ram)
        } else if control_due {
            self.continue_control(now, device, ram)
        } else if !self.sending.is_empty() && self.bulk_out.ready_at <= now {
            self.write_bulk(now, device, ram)
        } else {
            self.read_bulk(now, device, ram)
        };
        // Token, data with its worst-case bit stuffing, handshake and the gaps between them, at 12 bits a µs.
        self.bus_free_at = now + (100 + bytes as Ticks * 28 / 3) * MICROSECOND / 12;
    }

    fn poll_notifications(&mut self, now: Ticks, device: &mut UsbController, ram: &Ram) -> usize {
        self.notifications.ready_at = now + 32 * MILLISECOND;
        match device.transact(self.address, self.notifications.endpoint, &Token::In, ram) {
            Answer::Data(data, _) => data.len(),
            _ => 0,
        }
    }

    fn read_bulk(&mut self, now: Ticks, device: &mut UsbController, ram: &Ram) -> usize {
        match device.transact(self.address, self.bulk_in.endpoint, &Token::In, ram) {
            Answer::Data(data, toggle) => {
                if data.len() > MAX_PACKET {
                    self.complaints
                        .push(format!("a bulk packet of {} bytes", data.len()));
                }
                if toggle == self.bulk_in.toggle {
                    self.bulk_in.toggle = !toggle;
                    self.received.extend_from_slice(&data);
                } else {
                    self.complaints.push(format!(
                        "bulk data with DATA{} where DATA{} was due; the host drops it as a repetition",
                        u8::from(toggle),
                        u8::from(self.bulk_in.toggle)
                    ));
                }
                data.len()
            }
            Answer::Stall => {
                self.complaints
                    .push("the device stalls its bulk IN endpoint".into());
                self.bulk_in.ready_at = NEVER;
                0
            }
            _ => {
                self.bulk_in.ready_at = now + RETRY;
                0
            }
        }
    }

    fn write_bulk(&mut self, now: Ticks, device: &mut UsbController, ram: &Ram) -> usize {
        let packet: Vec<u8> = self.sending.iter().copied().take(MAX_PACKET).collect();
        let length = packet.len();
        match device.transact(
            self.address,
            self.bulk_out.endpoint,
            &Token::Out(packet, self.bulk_out.toggle),
            ram,
        ) {
            Answer::Ack => {
                self.bulk_out.toggle = !self.bulk_out.toggle;
                self.sending.drain(..length);
            }
            _ => self.bulk_out.ready_at = now + RETRY,
        }
        length
    }

    fn continue_control(&mut self, now: Ticks, device: &mut UsbController, ram: &Ram) -> usize {
        let (address, frame_end) = (self.address, self.next_frame);
        if self.transfer.is_none() {
            let request = match &self.enumeration {
                Some(enumeration) => enumeration.request(),
                None => self.requests.front().cloned(),
            };
            self.transfer = request.map(|request| Transfer::new(request, now));
        }
        let Some(transfer) = &mut self.transfer else {
            return 0;
        };
        let progress = transfer.step(now, &mut self.complaints, |token| {
            device.transact(address, 0, token, ram)
        });
        match progress {
            control::Progress::Moved(bytes) => {
                self.transfer_ready_at = now;
                bytes
            }
            control::Progress::Wait => {
                self.transfer_ready_at = now + RETRY;
                0
            }
            control::Progress::Lost => {
                self.transfer_ready_at = frame_end + 10 * MICROSECOND;
                0
            }
            control::Progress::Ended(outcome) => {
                self.transfer = None;
                self.transfer_ready_at = now + BETWEEN_TRANSFERS;
                self.end_control(now, outcome, device);
                0
            }
        }
    }

    fn end_control(&mut self, now: Ticks, outcome: Outcome, device: &mut UsbController) {
        let Some(enumeration) = &mut self.enumeration else {
            if let Some(request) = self.requests.pop_front() {
                if request.is_set_configuration() {
                    self.reset_toggles();
                }
                self.outcomes.push((request, outcome));
            }
            return;
        };
        match enumeration.ended(outcome) {
            Ok(enumeration::Next::Go) => {}
            Ok(enumeration::Next::ResetBus) => self.drive_reset(now, device),
            Ok(enumeration::Next::UseAddress(address)) => {
                self.address = address;
                self.transfer_ready_at = now + 2 * MILLISECOND;
            }
            Ok(enumeration::Next::Done) => {
                let found = self.enumeration.take().expect("it has just ended").found();
                self.bulk_in.endpoint = found.bulk_in;
                self.bulk_out.endpoint = found.bulk_out;
                self.notifications.endpoint = found.notifications;
                self.reset_toggles();
                for pipe in [
                    &mut self.bulk_in,
                    &mut self.bulk_out,
                    &mut self.notifications,
                ] {
                    pipe.ready_at = now;
                }
                self.identity = Some(found.identity);
            }
            Err(why) => {
                self.complaints.push(format!("enumeration failed: {why}"));
                // A PC tries again a few times; here the next bus reset does.
                self.cable = Cable::Settling(now + 500 * MILLISECOND);
            }
        }
    }

    /// A configured device starts every data pipe with DATA0 (USB 2.0, 9.1.1.5).
    fn reset_toggles(&mut self) {
        self.bulk_in.toggle = false;
        self.bulk_out.toggle = false;
        self.notifications.toggle = false;
    }
}

impl Default for Host {
    fn default() -> Host {
        Host::new()
    }
}
