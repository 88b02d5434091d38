//! What a transaction of the host needs: the device, the address it has, and who notes what it does wrong.

use crate::cpu::Ram;
use crate::journal::Happening;
use crate::peripherals::usbotg::UsbController;
use crate::time::{MICROSECOND, Ticks};
use crate::usb_transaction::{Answer, Token};
use crate::witness::{Trap, Witness};

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
    pub noise: &'a mut Noise,
}

/// What disturbs the cable.
#[derive(Debug, Clone, Default)]
pub(super) struct Noise {
    /// Every so many transactions; 0 is never.
    pub every: u32,
    passed: u32,
}

/// What noise does to a transaction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Disturbance {
    None,
    /// The packet to the device is damaged.
    Packet,
    /// The device's handshake is lost.
    Handshake,
}

impl Noise {
    fn next(&mut self) -> Disturbance {
        if self.every == 0 {
            return Disturbance::None;
        }
        self.passed += 1;
        if !self.passed.is_multiple_of(self.every) {
            Disturbance::None
        } else if (self.passed / self.every).is_multiple_of(2) {
            Disturbance::Handshake
        } else {
            Disturbance::Packet
        }
    }
}

impl Wire<'_> {
    /// One transaction with endpoint `number`; `repeated` if the device may have taken it before.
    pub fn transact(&mut self, number: u8, token: &Token, repeated: bool) -> Answer {
        let disturbance = self.noise.next();
        if disturbance == Disturbance::Packet {
            self.device.damaged();
            return Answer::Silence;
        }
        let answer = self
            .device
            .transact(self.address, number, token, self.ram, self.witness);
        self.device.journal.note(0, || Happening::Usb {
            address: self.address,
            endpoint: number,
            token: token.clone(),
            answer: answer.clone(),
        });
        match (answer, token) {
            (Answer::Ack | Answer::Dropped, _) if disturbance == Disturbance::Handshake => {
                Answer::Silence
            }
            (Answer::Dropped, Token::Out(data, toggle)) => {
                // An empty packet has nothing to lose: Teensyduino expects the first status stage as DATA0.
                if !repeated && !data.is_empty() {
                    self.witness.saw(
                        Trap::UsbToggle,
                        format!(
                            "the host sends DATA{0} to endpoint {number}, whose descriptor expects DATA{1}: {2} bytes \
                             are taken for a repetition and lost",
                            u8::from(*toggle),
                            u8::from(!*toggle),
                            data.len()
                        ),
                    );
                }
                Answer::Ack
            }
            (answer, _) => answer,
        }
    }

    /// When a transaction without a handshake is repeated: early in the next frame.
    pub fn next_try(&self) -> Ticks {
        self.frame_end + 10 * MICROSECOND
    }
}
