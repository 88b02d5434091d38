//! The chip's USB controller (K20 manual, chapter 43) as `usb-device` wants it.
//!
//! Each endpoint has two buffers per direction, used in turn ([`super::buffers`]). The rules that matter
//! here:
//!
//! * Tokens are reported one per [`UsbBus::poll`], in their order; merging them would let a SETUP hide
//!   the end of the status stage before it.
//! * After a SETUP the controller holds all traffic (TXSUSPENDTOKENBUSY). In that pause whatever was
//!   queued for the control transfer before is withdrawn, and the next packet is expected as DATA1.
//! * A stalled control endpoint answers one token with STALL; then it must be open for the next SETUP.
//!   EPSTALL is therefore withdrawn as soon as the controller reports the handshake.
//! * OUT descriptors carry DTS, so a packet that is repeated because its handshake was lost is
//!   acknowledged and dropped by the controller.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};
use mk20dx_hal::pac;
use usb_device::bus::{PollResult, UsbBus};
use usb_device::endpoint::{EndpointAddress, EndpointType};
use usb_device::{Result, UsbDirection, UsbError};

use super::buffers::{self, ENDPOINTS, PACKET, descriptor};
use super::endpoints::{Endpoints, Receive, Transmit};

/// ISTAT flags, cleared by writing them as 1.
pub(super) mod flag {
    pub const STALL: u8 = 1 << 7;
    pub const RESUME: u8 = 1 << 5;
    pub const SLEEP: u8 = 1 << 4;
    pub const TOKEN: u8 = 1 << 3;
    pub const START_OF_FRAME: u8 = 1 << 2;
    pub const ERROR: u8 = 1 << 1;
    pub const RESET: u8 = 1 << 0;
}

/// Interrupts while the bus is in use, and while it is suspended.
pub(super) const AWAKE: u8 = flag::STALL | flag::SLEEP | flag::TOKEN | flag::ERROR | flag::RESET;
const SUSPENDED: u8 = flag::RESUME | flag::START_OF_FRAME | flag::RESET;

/// STAT.TX: the token was an IN.
pub(super) const TO_HOST: u8 = 1 << 3;

/// Completed tokens that STAT can hold.
const COMPLETED: usize = 4;

/// CTL.
const ODD_RESET: u8 = 1 << 1;
const ENABLE: u8 = 1 << 0;

/// ENDPTn.
const HANDSHAKE: u8 = 1 << 0;
const STALLED: u8 = 1 << 1;
const TRANSMIT: u8 = 1 << 2;
const RECEIVE: u8 = 1 << 3;
/// No SETUP on this endpoint.
const NO_CONTROL: u8 = 1 << 4;

/// The controller.
pub struct Bus {
    state: UnsafeCell<Endpoints>,
    /// Frames are followed.
    pub(super) frames: AtomicBool,
}

// SAFETY: all of this runs in the USB interrupt, or in the main program while that is masked; and `with`, the only one
// to reach for the state, does not call itself.
unsafe impl Sync for Bus {}

pub(super) fn registers() -> &'static pac::usb0::RegisterBlock {
    // SAFETY: the controller is always there, and Bus::new has taken the only handle on it.
    unsafe { &*pac::Usb0::PTR }
}

impl Bus {
    /// Clocks the controller with 48 MHz from the 72 MHz PLL.
    pub fn new(_registers: pac::Usb0, sim: &pac::Sim) -> Bus {
        // 72 MHz × (1 + 1) / (2 + 1)
        // SAFETY: a legal divider; it is set before the clock is let through.
        sim.clkdiv2()
            .write(|w| unsafe { w.usbfrac().set_bit().usbdiv().bits(2) });
        sim.sopt2()
            .modify(|_, w| w.usbsrc().set_bit().pllfllsel().set_bit());
        sim.scgc4().modify(|_, w| w.usbotg().enabled());
        Bus {
            state: UnsafeCell::new(Endpoints::default()),
            frames: AtomicBool::new(false),
        }
    }

    pub(super) fn with<T>(&self, work: impl FnOnce(&mut Endpoints) -> T) -> T {
        // SAFETY: see above.
        work(unsafe { &mut *self.state.get() })
    }

    /// Interrupts while the bus is in use.
    pub(super) fn awake(&self) -> u8 {
        match self.frames.load(Ordering::Relaxed) {
            true => AWAKE | flag::START_OF_FRAME,
            false => AWAKE,
        }
    }

    pub(super) fn clear(&self, flags: u8) {
        // SAFETY: ISTAT takes any value; it clears the flags written as 1.
        registers().istat().write(|w| unsafe { w.bits(flags) });
    }

    pub(super) fn interrupts(&self, flags: u8) {
        // SAFETY: INTEN takes any value.
        registers().inten().write(|w| unsafe { w.bits(flags) });
    }

    fn control(&self, bits: u8) {
        // Written whole: a read-modify-write would set TXSUSPENDTOKENBUSY again.
        // SAFETY: device mode; bits of host mode are never passed.
        registers().ctl().write(|w| unsafe { w.bits(bits) });
    }

    fn endpoint(&self, number: usize, bits: u8) {
        // SAFETY: all bits of ENDPTn are defined in device mode.
        registers().endpt(number).write(|w| unsafe { w.bits(bits) });
    }

    fn endpoint_bits(&self, number: usize) -> u8 {
        registers().endpt(number).read().bits()
    }

    /// One completed token.
    fn token(&self, status: u8) -> PollResult {
        let (number, transmit) = (usize::from(status >> 4), status & TO_HOST != 0);
        let bank = usize::from(status >> 2 & 1);
        let bit = 1u16 << number;
        if number >= ENDPOINTS {
            return PollResult::None;
        }
        if transmit {
            self.sent(status);
            return PollResult::Data {
                ep_out: 0,
                ep_in_complete: bit,
                ep_setup: 0,
            };
        }
        if descriptor(number, false, bank).holds_setup() {
            self.setup(bank);
            return PollResult::Data {
                ep_out: 0,
                ep_in_complete: 0,
                ep_setup: bit,
            };
        }
        self.with(|state| {
            let endpoint = &mut state.receive[number];
            endpoint.filled = (endpoint.filled + 1).min(2);
        });
        PollResult::Data {
            ep_out: bit,
            ep_in_complete: 0,
            ep_setup: 0,
        }
    }

    /// A SETUP lies in `bank` of endpoint 0; the controller waits.
    fn setup(&self, bank: usize) {
        let mut request = buffers::received(0, bank);
        let (kind, number) = (
            request.next().unwrap_or_default(),
            request.next().unwrap_or_default(),
        );
        self.with(|state| {
            // Whatever was to be sent belongs to a transfer that is over.
            descriptor(0, true, 0).withdraw();
            descriptor(0, true, 1).withdraw();
            let transmit = &mut state.transmit[0];
            (transmit.busy, transmit.data1, transmit.stalled) = (false, true, false);
            // So does a packet that came in before and was not read. Data and status begin with DATA1.
            let receive = &mut state.receive[0];
            receive.stalled = false;
            receive.data1[bank] = false;
            receive.data1[bank ^ 1] = true;
            let other = descriptor(0, false, bank ^ 1);
            if other.is_given() {
                other.set_toggle(true);
            } else {
                other.give(receive.size, true);
            }
            (receive.bank, receive.filled) = (bank, 1);
            // SET_CONFIGURATION and SET_INTERFACE start every data pipe anew (USB 2.0, 9.1.1.5), which
            // usb-device does not pass on.
            if matches!((kind, number), (0x00, 0x09) | (0x01, 0x0B)) {
                for endpoint in 1..ENDPOINTS {
                    state.restart_toggles(endpoint);
                }
            }
        });
        self.endpoint(0, HANDSHAKE | TRANSMIT | RECEIVE);
        self.control(ENABLE);
    }
}

impl UsbBus for Bus {
    fn alloc_ep(
        &mut self,
        direction: UsbDirection,
        address: Option<EndpointAddress>,
        kind: EndpointType,
        size: u16,
        _interval: u8,
    ) -> Result<EndpointAddress> {
        let size = usize::from(size);
        if size > PACKET {
            return Err(UsbError::Unsupported);
        }
        self.with(|state| {
            let used =
                |state: &Endpoints, n: usize| state.transmit[n].size + state.receive[n].size > 0;
            let number = match (address, kind) {
                (Some(address), _) => address.index(),
                (None, EndpointType::Control) => 0,
                // A number for each, so that an endpoint can be stalled without its neighbour.
                (None, _) => (1..ENDPOINTS)
                    .find(|&n| !used(state, n))
                    .ok_or(UsbError::EndpointOverflow)?,
            };
            if number >= ENDPOINTS {
                return Err(UsbError::InvalidEndpoint);
            }
            match direction {
                UsbDirection::In => state.transmit[number].size = size,
                UsbDirection::Out => state.receive[number].size = size,
            }
            Ok(EndpointAddress::from_parts(number, direction))
        })
    }

    fn enable(&mut self) {
        let [_, page1, page2, page3] = buffers::connect().to_le_bytes();
        // SAFETY: the table is static and aligned to 512 bytes.
        registers().bdtpage1().write(|w| unsafe { w.bits(page1) });
        // SAFETY: as above.
        registers().bdtpage2().write(|w| unsafe { w.bits(page2) });
        // SAFETY: as above.
        registers().bdtpage3().write(|w| unsafe { w.bits(page3) });
        self.clear(0xFF);
        self.control(ENABLE);
        // SAFETY: not suspended, no weak pull-downs.
        registers().usbctrl().write(|w| unsafe { w.bits(0) });
        self.interrupts(self.awake());
        registers()
            .control()
            .write(|w| w.dppullupnonotg().set_bit());
    }

    fn reset(&self) {
        self.control(ENABLE | ODD_RESET);
        // SAFETY: full speed, address 0.
        registers().addr().write(|w| unsafe { w.bits(0) });
        self.with(|state| {
            for number in 0..ENDPOINTS {
                for (transmit, bank) in [(false, 0), (false, 1), (true, 0), (true, 1)] {
                    descriptor(number, transmit, bank).withdraw();
                }
                let transmit = &mut state.transmit[number];
                *transmit = Transmit {
                    size: transmit.size,
                    ..Transmit::default()
                };
                let receive = &mut state.receive[number];
                *receive = Receive {
                    size: receive.size,
                    data1: [false, true],
                    ..Receive::default()
                };
                let mut bits = HANDSHAKE;
                if number != 0 {
                    bits |= NO_CONTROL;
                }
                if transmit.size > 0 {
                    bits |= TRANSMIT;
                }
                if receive.size > 0 {
                    bits |= RECEIVE;
                    descriptor(number, false, 0).give(receive.size, false);
                    descriptor(number, false, 1).give(receive.size, true);
                }
                self.endpoint(
                    number,
                    if bits & (TRANSMIT | RECEIVE) == 0 {
                        0
                    } else {
                        bits
                    },
                );
            }
        });
        // Tokens from before the reset mean nothing any more; each clearing takes one out of STAT.
        for _ in 0..COMPLETED {
            self.clear(flag::TOKEN);
        }
        self.clear(0xFF);
        // SAFETY: ERRSTAT takes any value; it clears the flags written as 1.
        registers().errstat().write(|w| unsafe { w.bits(0xFF) });
        self.interrupts(self.awake());
        self.control(ENABLE);
    }

    fn set_device_address(&self, address: u8) {
        // SAFETY: usb-device passes seven bits; the eighth would select low speed.
        registers()
            .addr()
            .write(|w| unsafe { w.bits(address & 0x7F) });
    }

    fn write(&self, address: EndpointAddress, data: &[u8]) -> Result<usize> {
        let number = address.index();
        self.with(|state| {
            let endpoint = state
                .transmit
                .get_mut(number)
                .ok_or(UsbError::InvalidEndpoint)?;
            if data.len() > endpoint.size {
                return Err(UsbError::BufferOverflow);
            }
            if endpoint.busy {
                return Err(UsbError::WouldBlock);
            }
            buffers::fill(number, endpoint.bank, data);
            endpoint.busy = true;
            descriptor(number, true, endpoint.bank).give(data.len(), endpoint.data1);
            Ok(data.len())
        })
    }

    fn read(&self, address: EndpointAddress, data: &mut [u8]) -> Result<usize> {
        let number = address.index();
        self.with(|state| {
            let endpoint = state
                .receive
                .get_mut(number)
                .ok_or(UsbError::InvalidEndpoint)?;
            if endpoint.filled == 0 {
                return Err(UsbError::WouldBlock);
            }
            let bank = endpoint.bank;
            let descriptor = descriptor(number, false, bank);
            let count = descriptor.length();
            let received = buffers::received(number, bank);
            for (place, byte) in data.iter_mut().zip(received).take(count) {
                *place = byte;
            }
            endpoint.filled -= 1;
            endpoint.bank ^= 1;
            descriptor.give(endpoint.size, endpoint.data1[bank]);
            // A packet too long for the caller is lost, but does not block those behind it.
            if count > data.len() {
                Err(UsbError::BufferOverflow)
            } else {
                Ok(count)
            }
        })
    }

    fn set_stalled(&self, address: EndpointAddress, stalled: bool) {
        let number = address.index();
        if number >= ENDPOINTS {
            return;
        }
        let was_stalled = self.with(|state| {
            let flag = match address.direction() {
                UsbDirection::In => &mut state.transmit[number].stalled,
                UsbDirection::Out => &mut state.receive[number].stalled,
            };
            let before = core::mem::replace(flag, stalled);
            if before && !stalled && number != 0 {
                // Clearing a halt starts the pipe anew (USB 2.0, 9.4.5); the endpoint is still stalled
                // here, so the controller leaves its descriptors alone.
                state.restart_toggles(number);
            }
            before
        });
        if was_stalled || stalled {
            let bits = self.endpoint_bits(number);
            self.endpoint(
                number,
                if stalled {
                    bits | STALLED
                } else {
                    bits & !STALLED
                },
            );
        }
    }

    fn is_stalled(&self, address: EndpointAddress) -> bool {
        let number = address.index() % ENDPOINTS;
        self.with(|state| match address.direction() {
            UsbDirection::In => state.transmit[number].stalled,
            UsbDirection::Out => state.receive[number].stalled,
        })
    }

    fn suspend(&self) {
        self.clear(flag::RESUME | flag::START_OF_FRAME);
        self.interrupts(SUSPENDED);
    }

    fn resume(&self) {
        self.interrupts(self.awake());
    }

    fn poll(&self) -> PollResult {
        let flags = registers().istat().read().bits();
        let enabled = registers().inten().read().bits();
        if flags & flag::RESET != 0 {
            return PollResult::Reset;
        }
        if flags & flag::ERROR != 0 {
            // The controller has refused a damaged packet and the host repeats it: nothing to do.
            // SAFETY: ERRSTAT takes any value; it clears the flags written as 1.
            registers().errstat().write(|w| unsafe { w.bits(0xFF) });
            self.clear(flag::ERROR);
        }
        if flags & flag::STALL != 0 {
            self.clear(flag::STALL);
            self.endpoint(0, self.endpoint_bits(0) & !STALLED);
        }
        if flags & flag::TOKEN != 0 {
            // STAT shows the oldest token; clearing the flag moves on to the next.
            let status = registers().stat().read().bits();
            let result = self.token(status);
            self.clear(flag::TOKEN);
            return result;
        }
        if flags & enabled & (flag::RESUME | flag::START_OF_FRAME) != 0 {
            self.clear(flag::RESUME | flag::START_OF_FRAME);
            return PollResult::Resume;
        }
        if flags & enabled & flag::SLEEP != 0 {
            self.clear(flag::SLEEP);
            return PollResult::Suspend;
        }
        PollResult::None
    }
}
