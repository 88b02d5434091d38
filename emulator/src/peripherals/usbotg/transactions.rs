//! Tokens and handshakes: what the controller does when the host addresses one of its endpoints.

use super::table::{Descriptor, Pid, Place};
use super::{COMPLETED, CRC16, DMAERR, UsbController, ctl, endpt, istat};
use crate::cpu::Ram;
use crate::usb_transaction::{Answer, Token};
use crate::witness::{Trap, Witness};

/// A packet that the controller may take: the descriptor for it is the controller's.
struct Transaction<'a> {
    place: Place,
    at: u32,
    descriptor: Descriptor,
    /// Isochronous endpoints have no handshakes.
    handshakes: bool,
    ram: &'a Ram,
}

impl UsbController {
    /// Address of the buffer descriptor table.
    pub fn table(&self) -> u32 {
        u32::from_be_bytes([self.bdt_page[2], self.bdt_page[1], self.bdt_page[0], 0])
    }

    /// Whether the word at `address` is the status of a descriptor, by which the program has just given the controller a
    /// packet for the host, on another endpoint than 0. A bank that has to wait for its turn counts as well.
    pub fn is_armed_by(&self, address: u32, ram: &Ram) -> bool {
        const ENTRY: u32 = 8;
        let offset = address.wrapping_sub(self.table());
        let index = offset / ENTRY;
        let transmits = index & 2 != 0;
        (4..64).contains(&index)
            && offset.is_multiple_of(ENTRY)
            && transmits
            && Descriptor::read(address, ram).is_some_and(Descriptor::is_owned)
    }

    /// Whether the host has begun to take a packet, of another endpoint than 0, since this was last asked.
    pub fn take_gone(&mut self) -> bool {
        std::mem::take(&mut self.gone)
    }

    /// Looks whether the program has touched what the controller owns, in both banks of an endpoint.
    pub(super) fn look_at_owners(
        &mut self,
        endpoint: u8,
        transmit: bool,
        ram: &Ram,
        witness: &mut Witness,
    ) {
        let enable = if transmit {
            endpt::EPTXEN
        } else {
            endpt::EPRXEN
        };
        let bits = self.endpoints[usize::from(endpoint)];
        if bits & enable == 0 || bits & endpt::EPSTALL != 0 {
            return;
        }
        for odd in [false, true] {
            let place = Place {
                endpoint,
                transmit,
                odd,
            };
            if let Some(found) = Descriptor::read(place.address(self.table()), ram) {
                self.ownership.look(place, found, witness);
            }
        }
    }

    /// One transaction for `address` and `endpoint`.
    pub fn transact(
        &mut self,
        address: u8,
        endpoint: u8,
        token: &Token,
        ram: &Ram,
        witness: &mut Witness,
    ) -> Answer {
        let endpoint = endpoint & 0xF;
        let bits = self.endpoints[usize::from(endpoint)];
        let transmit = *token == Token::In;
        let setup = matches!(token, Token::Setup(_));
        let needed = match token {
            Token::In => endpt::EPTXEN,
            Token::Out(..) => endpt::EPRXEN,
            Token::Setup(_) => endpt::EPTXEN | endpt::EPRXEN,
        };
        let for_us = self.is_listening() && self.address() == address;
        if !for_us || bits & needed != needed || setup && bits & endpt::EPCTLDIS != 0 {
            return Answer::Silence;
        }
        let handshakes = bits & endpt::EPHSHK != 0;
        // A SETUP is never NAKed (USB 2.0, 8.5.3): where the controller has no room for it, it is lost.
        let refuse = |answer: Answer| {
            if setup || !handshakes {
                Answer::Silence
            } else {
                answer
            }
        };
        // The manual says it of any access, so of a SETUP too.
        if bits & endpt::EPSTALL != 0 {
            self.istat |= istat::STALL;
            return Answer::Stall;
        }
        if self.ctl & ctl::TXSUSPENDTOKENBUSY != 0 || self.completed.len() >= COMPLETED {
            return refuse(Answer::Nak);
        }
        let place = Place {
            endpoint,
            transmit,
            odd: self.odd[usize::from(endpoint)][usize::from(transmit)],
        };
        let at = place.address(self.table());
        let Some(descriptor) = Descriptor::read(at, ram) else {
            witness.saw(
                Trap::UsbTableOutside,
                format!("the controller needs {place}, and finds no RAM at {at:#010x}"),
            );
            return Answer::Silence;
        };
        if !self.is_quiet() {
            self.look_at_owners(endpoint, transmit, ram, witness);
        }
        if !descriptor.is_owned() {
            return refuse(Answer::Nak);
        }
        if descriptor.stalls() {
            self.istat |= istat::STALL;
            return Answer::Stall;
        }
        let transaction = Transaction {
            place,
            at,
            descriptor,
            handshakes,
            ram,
        };
        match token {
            Token::In => self.give(&transaction, witness),
            Token::Out(data, toggle) => {
                if descriptor.synchronises() && handshakes && *toggle != descriptor.data1() {
                    return Answer::Dropped;
                }
                self.take(&transaction, data, Pid::Out, witness)
            }
            Token::Setup(data) => {
                let answer = self.take(&transaction, data, Pid::Setup, witness);
                if answer == Answer::Ack {
                    self.ctl |= ctl::TXSUSPENDTOKENBUSY;
                    self.address_to_come = (data[..2] == [0x00, 0x05]).then_some(data[2]);
                }
                answer
            }
        }
    }

    /// A packet comes that is damaged; the controller does not answer it.
    pub fn damaged(&mut self) {
        if self.is_listening() {
            self.error(CRC16);
        }
    }

    /// An IN token finds its buffer.
    fn give(&mut self, transaction: &Transaction<'_>, witness: &mut Witness) -> Answer {
        let Transaction {
            place,
            descriptor,
            ram,
            ..
        } = *transaction;
        let length = descriptor.count();
        let data = if descriptor.is_fifo() {
            ram.bytes(descriptor.buffer, length.min(1))
                .map(|byte| byte.repeat(length))
        } else {
            ram.bytes(descriptor.buffer, length)
        };
        let Some(data) = data else {
            witness.saw(
                Trap::UsbBufferOutside,
                format!(
                    "{place} has its {length} bytes at {:#010x}",
                    descriptor.buffer
                ),
            );
            return Answer::Silence;
        };
        self.complete(transaction, length, Pid::In);
        if place.endpoint == 0 {
            self.address_to_come = None;
        } else {
            self.gone = true;
        }
        Answer::Data(data, descriptor.data1())
    }

    /// A SETUP or OUT packet finds its buffer.
    fn take(
        &mut self,
        transaction: &Transaction<'_>,
        data: &[u8],
        pid: Pid,
        witness: &mut Witness,
    ) -> Answer {
        let Transaction {
            place,
            descriptor,
            ram,
            ..
        } = *transaction;
        let room = descriptor.count();
        let fits = &data[..data.len().min(room)];
        let stored = if descriptor.is_fifo() {
            ram.set_bytes(descriptor.buffer, &fits[fits.len().saturating_sub(1)..])
        } else {
            ram.set_bytes(descriptor.buffer, fits)
        };
        if !stored {
            witness.saw(
                Trap::UsbBufferOutside,
                format!(
                    "{place} has room for {room} bytes at {:#010x}",
                    descriptor.buffer
                ),
            );
            return Answer::Silence;
        }
        if data.len() > room {
            witness.saw(
                Trap::UsbBufferTooSmall,
                format!(
                    "{} bytes come for {place}, whose buffer has room for {room}",
                    data.len()
                ),
            );
            self.error(DMAERR);
            return Answer::Silence;
        }
        self.complete(transaction, data.len(), pid);
        if transaction.handshakes {
            Answer::Ack
        } else {
            Answer::Silence
        }
    }

    fn complete(&mut self, transaction: &Transaction<'_>, length: usize, pid: Pid) {
        let Transaction {
            place,
            at,
            descriptor,
            ram,
            ..
        } = *transaction;
        let odd = &mut self.odd[usize::from(place.endpoint)][usize::from(place.transmit)];
        *odd = !*odd && self.ctl & ctl::ODDRST == 0;
        // A kept descriptor stays as it is, and the program is not told.
        if !descriptor.keeps() {
            ram.set_word(at, descriptor.completed(pid, length));
            self.ownership.gave_back(place);
            self.completed.push_back(place);
            self.istat |= istat::TOKDNE;
        }
    }
}
