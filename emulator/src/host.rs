//! A USB host on the other end of the cable.
//!
//! ```text
//! serial: the built-in host: configures the device, opens and reads its port ─┐
//!                                                                             ├─► bus ──► controller
//! export: hands the device to another host, see [`crate::usbip`] ─────────────┘
//! ```
//!
//! It judges as it goes: data toggles, packet sizes, descriptors, answers that never come. What it objects to goes to the
//! [`Witness`].

mod bus;

mod control;

mod descriptors;

mod enumeration;

mod export;

mod introduction;

mod pipe;

mod serial;

mod transfer;

mod wire;

pub use descriptors::Interface;
pub use enumeration::Profile;
pub use export::Handover;
pub use transfer::{Failure, Outcome, Request, Ticket, Transfer};

use crate::cpu::Ram;
use crate::peripherals::usbotg::UsbController;
use crate::time::Ticks;
use crate::witness::Witness;
use bus::{Bus, Event};
use export::Export;
use introduction::Introduction;
use serial::SerialPort;

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

/// The host.
#[derive(Debug, Clone)]
pub struct Host {
    bus: Bus,
    introduction: Introduction,
    profile: Option<Profile>,
    serial: SerialPort,
    /// In the place of the serial driver.
    export: Option<Export>,
}

impl Host {
    /// A host with the cable plugged in and its serial port to be opened and read.
    pub fn new() -> Host {
        Host {
            bus: Bus::new(),
            introduction: Introduction::default(),
            profile: None,
            serial: SerialPort::new(),
            export: None,
        }
    }

    /// A host that hands the device out instead of using it.
    pub fn exporting() -> Host {
        Host {
            export: Some(Export::new()),
            ..Host::new()
        }
    }

    /// Whether the device is configured and its port is open.
    pub fn is_open(&self) -> bool {
        self.serial.is_open()
    }

    /// The device, once it was enumerated.
    pub fn identity(&self) -> Option<&Identity> {
        self.profile().map(|profile| &profile.identity)
    }

    /// All that the device says about itself, once it was enumerated.
    pub fn profile(&self) -> Option<&Profile> {
        self.profile.as_ref()
    }

    /// Takes what the serial port has delivered.
    pub fn take_received(&mut self) -> Vec<u8> {
        self.serial.take_received()
    }

    /// Writes to the serial port.
    pub fn send(&mut self, bytes: &[u8]) {
        self.serial.send(bytes);
        self.go_on();
    }

    /// Whether the host reads the port; one that stopped leaves the device's packets where they are.
    pub fn set_reading(&mut self, reading: bool) {
        self.serial.set_reading(reading);
        self.go_on();
    }

    /// Resets the bus and enumerates anew, as a PC does when a driver asks for it.
    pub fn reset_bus(&mut self) {
        self.forget_device();
        self.bus.settle_again(0);
    }

    /// Pulls the plug or puts it back.
    pub fn set_plugged(&mut self, plugged: bool) {
        self.bus.set_plugged(plugged);
    }

    /// Disturbs every so many transactions, in turn the packet to the device and its handshake; 0 is a clean cable.
    pub fn set_noise(&mut self, every: u32) {
        self.bus.set_noise(every);
    }

    /// Stops the frames, so that the device suspends itself, or resumes it.
    pub fn set_suspended(&mut self, suspended: bool) {
        self.bus.set_suspended(suspended);
    }

    /// Queues a control request for after enumeration.
    pub fn request(&mut self, request: Request) {
        self.serial.request(request);
        self.go_on();
    }

    /// Sets the speed of the serial port, which a PC does as a request to interface 0; 8 bits, no parity, one stop bit.
    pub fn set_baud(&mut self, baud: u32) {
        let [b0, b1, b2, b3] = baud.to_le_bytes();
        self.request(Request::write(0x21, 0x20, 0, 0, &[b0, b1, b2, b3, 0, 0, 8]));
    }

    /// Takes how the queued requests ended.
    pub fn take_outcomes(&mut self) -> Vec<(Request, Outcome)> {
        self.serial.take_outcomes()
    }

    /// How far the device is on its way to another host; [`Handover::Absent`] for a host that keeps it.
    pub fn handover(&self) -> Handover {
        self.export
            .as_ref()
            .map_or(Handover::Absent, |export| export.handover)
    }

    /// Begins to hand the device over, with a bus reset and an address; whether it was on offer.
    pub fn hand_over(&mut self) -> bool {
        self.export
            .as_mut()
            .is_some_and(|export| export.take(&mut self.bus))
    }

    /// Takes the device back: its transfers are given up and the bus falls silent.
    pub fn take_back(&mut self) {
        if let Some(export) = &mut self.export {
            export.put_back(&mut self.bus);
        }
    }

    /// Hands the bus a transfer of the other host's.
    pub fn submit(&mut self, transfer: Transfer) -> Ticket {
        self.bus.submit(transfer)
    }

    /// Gives a transfer up; whether it was still pending. It does not appear among those that ended.
    pub fn cancel(&mut self, ticket: Ticket) -> bool {
        self.bus.cancel(ticket)
    }

    /// Takes how the other host's transfers ended.
    pub fn take_ended(&mut self) -> Vec<(Ticket, Outcome)> {
        self.export
            .as_mut()
            .map(Export::take_ended)
            .unwrap_or_default()
    }

    /// When [`Host::advance`] has to be called next.
    pub fn next_event(&self) -> Ticks {
        self.bus.next_event()
    }

    /// Does what is due at `now`. `clocked` tells whether the device's USB module has its 48 MHz.
    pub fn advance(
        &mut self,
        now: Ticks,
        clocked: bool,
        device: &mut UsbController,
        ram: &Ram,
        witness: &mut Witness,
    ) {
        self.bus.advance(now, clocked, device, ram, witness);
        while let Some(event) = self.bus.take_event() {
            self.handle(event, now, witness);
        }
    }

    fn handle(&mut self, event: Event, now: Ticks, witness: &mut Witness) {
        if matches!(event, Event::Attached | Event::Detached) {
            self.forget_device();
        }
        let known = self
            .introduction
            .handle(&event, now, &mut self.bus, witness);
        match &mut self.export {
            Some(export) => export.handle(event, &mut self.bus),
            None => self.serial.handle(event),
        }
        if let Some(profile) = known {
            match &mut self.export {
                Some(export) => export.offer(&mut self.bus),
                None => self.serial.start(&profile, &self.bus),
            }
            self.profile = Some(profile);
        }
        self.go_on();
    }

    fn forget_device(&mut self) {
        self.profile = None;
        self.introduction.stop();
        self.serial.stop();
    }

    fn go_on(&mut self) {
        if self.export.is_none() {
            self.serial.go_on(&mut self.bus);
        }
    }
}

impl Default for Host {
    fn default() -> Host {
        Host::new()
    }
}
