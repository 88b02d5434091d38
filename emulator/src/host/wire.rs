//! What a transaction of the host needs: the device, the address it has, and who notes what it does wrong.

use crate::cpu::Ram;
use crate::peripherals::usbotg::{Answer, Token, UsbController};
use crate::time::{MICROSECOND, Ticks};
use crate::witness::Witness;

/// A NAKed bulk or control pipe is tried again after this time.
pub(super) const RETRY: Ticks = 40 * MICROSECOND;

/// This many transactions without a handshake end a transfer (USB 2.0, 10.2.6).
pub(super) const TRIES: u8 = 3;

/// The device at the other end of the cable, while a transaction lasts.
pub(super) struct Wire<'a> {
    pub now: Ticks,
    /// When the present frame ends.
    pub frame_end: Ticks,
    pub address: u8,
    pub device: &'a mut UsbController,
    pub ram: &'a Ram,
    pub witness: &'a mut Witness,
}

impl Wire<'_> {
    /// One transaction with endpoint `number`.
    pub fn transact(&mut self, number: u8, token: &Token) -> Answer {
        self.device
            .transact(self.address, number, token, self.ram, self.witness)
    }

    /// When a transaction without a handshake is repeated: early in the next frame.
    pub fn next_try(&self) -> Ticks {
        self.frame_end + 10 * MICROSECOND
    }
}
