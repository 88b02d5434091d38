//! A bulk, interrupt or isochronous pipe (USB 2.0, 5.6 to 5.8 and 8.6): transfers in turn, cut into packets, with the
//! toggle that each packet must have.

use std::collections::VecDeque;

use super::descriptors::{Endpoint, Kind};
use super::transfer::{Failure, Outcome, Ticket};
use super::wire::{RETRY, TRIES, Wire};
use crate::time::{MILLISECOND, Ticks};
use crate::usb_transaction::{Answer, Token};
use crate::witness::Trap;

/// A transfer on its way.
#[derive(Debug, Clone)]
enum Work {
    In {
        length: usize,
        got: Vec<u8>,
    },
    Out {
        data: Vec<u8>,
        sent: usize,
        closed: bool,
    },
}

/// The pipe.
#[derive(Debug, Clone)]
pub(super) struct Pipe {
    pub endpoint: Endpoint,
    /// The toggle the host expects or sends next.
    pub toggle: bool,
    /// The device has stalled it, and the host has not cleared that.
    pub halted: bool,
    /// Not tried before this time: NAKed, or not due yet.
    pub ready_at: Ticks,
    tries: u8,
    queue: VecDeque<(Ticket, Work)>,
}

impl Pipe {
    /// A pipe as it is after SET_CONFIGURATION: DATA0 comes first (USB 2.0, 9.1.1.5).
    pub fn new(endpoint: Endpoint) -> Pipe {
        Pipe {
            endpoint,
            toggle: false,
            halted: false,
            ready_at: 0,
            tries: 0,
            queue: VecDeque::new(),
        }
    }

    /// Whether the host serves it at fixed intervals, ahead of everything else.
    pub fn is_periodic(&self) -> bool {
        self.endpoint.kind != Kind::Bulk
    }

    /// Whether anything is to be done.
    pub fn is_busy(&self) -> bool {
        !self.queue.is_empty()
    }

    /// Queues a transfer that reads.
    pub fn read(&mut self, ticket: Ticket, length: usize) {
        let got = Vec::new();
        self.queue.push_back((ticket, Work::In { length, got }));
    }

    /// Queues a transfer that writes.
    pub fn write(&mut self, ticket: Ticket, data: Vec<u8>, closed: bool) {
        let sent = 0;
        self.queue
            .push_back((ticket, Work::Out { data, sent, closed }));
    }

    /// Gives a transfer up; whether there was one.
    pub fn cancel(&mut self, ticket: Ticket) -> bool {
        let before = self.queue.len();
        self.queue.retain(|&(queued, _)| queued != ticket);
        self.queue.len() != before
    }

    /// Gives all transfers up.
    pub fn clear(&mut self) -> impl Iterator<Item = Ticket> {
        std::mem::take(&mut self.queue)
            .into_iter()
            .map(|(ticket, _)| ticket)
    }

    /// CLEAR_FEATURE(ENDPOINT_HALT): the pipe begins with DATA0 again, whether it was halted or not (USB 2.0, 9.4.5).
    pub fn restart(&mut self) {
        self.toggle = false;
        self.halted = false;
    }

    /// Does the next transaction; returns the bytes that crossed the wire, and what has ended.
    pub fn transact(&mut self, wire: &mut Wire<'_>) -> (usize, Option<(Ticket, Outcome)>) {
        let Some((_, work)) = self.queue.front() else {
            return (0, None);
        };
        let token = match work {
            Work::In { .. } => Token::In,
            Work::Out { data, sent, .. } => {
                let rest = &data[*sent..];
                let packet = rest[..rest.len().min(self.endpoint.packet)].to_vec();
                Token::Out(packet, self.toggle)
            }
        };
        let answer = wire.transact(self.endpoint.number(), &token, self.tries > 0);
        let bytes = match (&token, &answer) {
            (Token::Out(data, _), _) | (_, Answer::Data(data, _)) => data.len(),
            _ => 0,
        };
        // Periodic pipes wait for their next turn whatever came.
        self.ready_at = if self.is_periodic() {
            wire.frame_end - MILLISECOND + u64::from(self.endpoint.frames()) * MILLISECOND
        } else {
            wire.now
        };
        let outcome = match answer {
            Answer::Silence if self.endpoint.kind == Kind::Isochronous => {
                self.packet_passed(&token, &[])
            }
            Answer::Silence => self.unanswered(wire),
            Answer::Nak => {
                self.tries = 0;
                self.ready_at = self.ready_at.max(wire.now + RETRY);
                None
            }
            Answer::Stall => {
                (self.tries, self.halted) = (0, true);
                Some(Outcome::Stalled)
            }
            Answer::Data(data, toggle) => self.data(&token, data, toggle, wire),
            Answer::Ack | Answer::Dropped => {
                self.note_lost_halt(wire);
                self.toggle = !self.toggle;
                self.packet_passed(&token, &[])
            }
        };
        let Some(outcome) = outcome else {
            return (bytes, None);
        };
        let ended = self.queue.pop_front();
        (bytes, ended.map(|(ticket, _)| (ticket, outcome)))
    }

    fn data(
        &mut self,
        token: &Token,
        data: Vec<u8>,
        toggle: bool,
        wire: &mut Wire<'_>,
    ) -> Option<Outcome> {
        self.note_lost_halt(wire);
        if data.len() > self.endpoint.packet {
            wire.witness.saw(
                Trap::UsbPacketTooLong,
                format!(
                    "{} sends a packet of {} bytes; its descriptor says {} at most",
                    self.endpoint,
                    data.len(),
                    self.endpoint.packet
                ),
            );
            return Some(Outcome::Failed(Failure::TooMuch));
        }
        if self.endpoint.kind != Kind::Isochronous {
            if toggle != self.toggle {
                wire.witness.saw(
                    Trap::UsbToggle,
                    format!(
                        "{} sends DATA{} where DATA{} is due; the host drops it as a repetition",
                        self.endpoint,
                        u8::from(toggle),
                        u8::from(self.toggle)
                    ),
                );
                return None;
            }
            self.toggle = !toggle;
        }
        self.packet_passed(token, &data)
    }

    /// A packet has gone one way or the other.
    fn packet_passed(&mut self, token: &Token, packet: &[u8]) -> Option<Outcome> {
        self.tries = 0;
        let full = self.endpoint.packet;
        match (&mut self.queue.front_mut()?.1, token) {
            (Work::In { length, got }, Token::In) => {
                got.extend_from_slice(packet);
                if got.len() > *length {
                    return Some(Outcome::Failed(Failure::TooMuch));
                }
                (packet.len() < full || got.len() == *length)
                    .then(|| Outcome::Done(std::mem::take(got)))
            }
            (Work::Out { data, sent, closed }, Token::Out(packet, _)) => {
                *sent += packet.len();
                let all = *sent == data.len();
                let open = *closed && packet.len() == full;
                (all && !open).then(|| Outcome::Done(Vec::new()))
            }
            _ => Some(Outcome::Failed(Failure::OutOfPlace)),
        }
    }

    fn unanswered(&mut self, wire: &mut Wire<'_>) -> Option<Outcome> {
        self.tries += 1;
        self.ready_at = self.ready_at.max(wire.next_try());
        if self.tries < TRIES {
            return None;
        }
        self.tries = 0;
        wire.witness.saw(
            Trap::UsbNoAnswer,
            format!(
                "three tokens for {} of the configuration have no answer",
                self.endpoint
            ),
        );
        Some(Outcome::Failed(Failure::NoAnswer))
    }

    /// A halted endpoint may answer with nothing but STALL.
    fn note_lost_halt(&mut self, wire: &mut Wire<'_>) {
        if std::mem::take(&mut self.halted) {
            wire.witness.saw(
                Trap::UsbHaltLost,
                format!("{} was halted and answers again", self.endpoint),
            );
        }
    }
}
