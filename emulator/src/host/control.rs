//! The control pipe (USB 2.0, 8.5.3): setup, data and status stage, with their toggles and retries.

use std::collections::VecDeque;

use super::transfer::{Failure, Outcome, Request, Ticket};
use super::wire::{RETRY, TRIES, Wire};
use crate::time::{MICROSECOND, SECOND, Ticks};
use crate::usb_transaction::{Answer, Token};
use crate::witness::Trap;

/// The host's drivers need a while before the next request.
const BETWEEN_REQUESTS: Ticks = 100 * MICROSECOND;
/// How long a request may be NAKed (USB 2.0, 9.2.6.1: no command takes more than 5 s).
const PATIENCE: Ticks = 5 * SECOND;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    Setup,
    Data,
    Status,
}

/// A request on its way.
#[derive(Debug, Clone)]
struct Running {
    stage: Stage,
    toggle: bool,
    sent: usize,
    received: Vec<u8>,
    tries: u8,
    deadline: Ticks,
}

/// Endpoint 0.
#[derive(Debug, Clone)]
pub(super) struct ControlPipe {
    queue: VecDeque<(Ticket, Request)>,
    running: Option<Running>,
    /// bMaxPacketSize0.
    pub packet: usize,
    /// Not tried before this time.
    pub ready_at: Ticks,
    /// The device has just got its address and has not answered there yet.
    pub fresh_address: bool,
}

/// A request that has ended.
pub(super) type Ended = (Ticket, Request, Outcome);

impl ControlPipe {
    /// The pipe of a device of which nothing is known yet.
    pub fn new() -> ControlPipe {
        ControlPipe {
            queue: VecDeque::new(),
            running: None,
            packet: 64,
            ready_at: 0,
            fresh_address: false,
        }
    }

    /// Queues a request.
    pub fn submit(&mut self, ticket: Ticket, request: Request) {
        self.queue.push_back((ticket, request));
    }

    /// Gives a request up; whether there was one.
    pub fn cancel(&mut self, ticket: Ticket) -> bool {
        let before = self.queue.len();
        if self
            .queue
            .front()
            .is_some_and(|&(first, _)| first == ticket)
        {
            self.running = None;
        }
        self.queue.retain(|&(queued, _)| queued != ticket);
        self.queue.len() != before
    }

    /// Gives all requests up.
    pub fn clear(&mut self) -> impl Iterator<Item = Ticket> {
        self.running = None;
        std::mem::take(&mut self.queue)
            .into_iter()
            .map(|(ticket, _)| ticket)
    }

    /// Whether anything is to be done.
    pub fn is_busy(&self) -> bool {
        !self.queue.is_empty()
    }

    /// Does the next transaction; returns the bytes that crossed the wire, and what has ended.
    pub fn transact(&mut self, wire: &mut Wire<'_>) -> (usize, Option<Ended>) {
        let Some((_, request)) = self.queue.front() else {
            return (0, None);
        };
        let running = self
            .running
            .get_or_insert_with(|| Running::new(wire.now + PATIENCE));
        let token = running.token(request, self.packet);
        let answer = match wire.transact(0, &token, running.tries > 0) {
            // Only ACK is an answer to a SETUP (USB 2.0, 8.4.6.4).
            Answer::Stall | Answer::Nak if running.stage == Stage::Setup => Answer::Silence,
            answer => answer,
        };
        let bytes = match (&token, &answer) {
            (Token::Setup(_), _) => 8,
            (Token::Out(data, _), _) | (_, Answer::Data(data, _)) => data.len(),
            _ => 0,
        };
        self.ready_at = wire.now;
        let outcome = match answer {
            Answer::Silence => {
                self.ready_at = wire.next_try();
                running.tries += 1;
                (running.tries >= TRIES).then(|| {
                    running.blame(request, self.fresh_address, wire);
                    Outcome::Failed(Failure::NoAnswer)
                })
            }
            Answer::Nak => {
                self.ready_at = wire.now + RETRY;
                (wire.now >= running.deadline).then(|| {
                    wire.witness.saw(
                        Trap::UsbRequestTimeout,
                        format!("request {:02x?} was NAKed for 5 s", request.setup),
                    );
                    Outcome::Failed(Failure::NotReady)
                })
            }
            answer => {
                running.tries = 0;
                self.fresh_address = false;
                running.advance(request, self.packet, &token, answer, wire)
            }
        };
        let Some(outcome) = outcome else {
            return (bytes, None);
        };
        self.running = None;
        self.ready_at = wire.now + BETWEEN_REQUESTS;
        let ended = self.queue.pop_front();
        (
            bytes,
            ended.map(|(ticket, request)| (ticket, request, outcome)),
        )
    }
}

impl Running {
    fn new(deadline: Ticks) -> Running {
        Running {
            stage: Stage::Setup,
            toggle: false,
            sent: 0,
            received: Vec::new(),
            tries: 0,
            deadline,
        }
    }

    fn token(&self, request: &Request, packet: usize) -> Token {
        match self.stage {
            Stage::Setup => Token::Setup(request.setup),
            Stage::Data if request.reads() => Token::In,
            Stage::Data => {
                let rest = &request.data[self.sent..];
                Token::Out(rest[..rest.len().min(packet)].to_vec(), self.toggle)
            }
            // The status stage runs against the data's direction and is always DATA1 (8.5.3.1).
            Stage::Status if request.reads() && request.length() > 0 => {
                Token::Out(Vec::new(), true)
            }
            Stage::Status => Token::In,
        }
    }

    /// Takes an answer in; tells how the request ended, if it did.
    fn advance(
        &mut self,
        request: &Request,
        packet: usize,
        token: &Token,
        answer: Answer,
        wire: &mut Wire<'_>,
    ) -> Option<Outcome> {
        match (answer, self.stage) {
            (Answer::Stall, _) => Some(Outcome::Stalled),
            (Answer::Ack, Stage::Setup) => {
                self.toggle = true;
                self.stage = if request.length() == 0 {
                    Stage::Status
                } else {
                    Stage::Data
                };
                None
            }
            (Answer::Data(data, toggle), Stage::Data) => {
                self.receive(request, packet, &data, toggle, wire)
            }
            (Answer::Ack, Stage::Data) => {
                if let Token::Out(data, _) = token {
                    self.sent += data.len();
                }
                self.toggle = !self.toggle;
                if self.sent >= request.data.len() {
                    self.stage = Stage::Status;
                }
                None
            }
            (Answer::Ack, Stage::Status) => Some(Outcome::Done(std::mem::take(&mut self.received))),
            (Answer::Data(data, toggle), Stage::Status) => {
                if !data.is_empty() || !toggle {
                    wire.witness.saw(
                        Trap::UsbStatusStage,
                        format!(
                            "request {:02x?}: its status stage is DATA{} with {} bytes",
                            request.setup,
                            u8::from(toggle),
                            data.len()
                        ),
                    );
                }
                Some(Outcome::Done(Vec::new()))
            }
            _ => Some(Outcome::Failed(Failure::OutOfPlace)),
        }
    }

    fn receive(
        &mut self,
        request: &Request,
        packet: usize,
        data: &[u8],
        toggle: bool,
        wire: &mut Wire<'_>,
    ) -> Option<Outcome> {
        if toggle != self.toggle {
            wire.witness.saw(
                Trap::UsbToggle,
                format!(
                    "request {:02x?}: DATA{} where DATA{} is due; the host drops it as a repetition",
                    request.setup,
                    u8::from(toggle),
                    u8::from(self.toggle)
                ),
            );
            return None;
        }
        self.toggle = !self.toggle;
        self.received.extend_from_slice(data);
        if data.len() > packet || self.received.len() > request.length() {
            wire.witness.saw(
                Trap::UsbTooMuchData,
                format!(
                    "request {:02x?}: a packet of {} bytes after {} of {} bytes, on an endpoint for {packet}",
                    request.setup,
                    data.len(),
                    self.received.len() - data.len(),
                    request.length()
                ),
            );
            return Some(Outcome::Failed(Failure::TooMuch));
        }
        if data.len() < packet || self.received.len() == request.length() {
            self.stage = Stage::Status;
        }
        None
    }

    /// Says why the device may be silent.
    fn blame(&self, request: &Request, fresh_address: bool, wire: &mut Wire<'_>) {
        let (trap, why) = match self.stage {
            Stage::Setup if fresh_address => (
                Trap::UsbAddressLate,
                format!(
                    "the device does not answer at address {}; its ADDR is {}",
                    wire.address,
                    wire.device.address()
                ),
            ),
            Stage::Setup => (
                Trap::UsbSetupLost,
                format!(
                    "SETUP {:02x?} was sent three times in three frames and not taken",
                    request.setup
                ),
            ),
            stage => (
                Trap::UsbNoAnswer,
                format!(
                    "request {:02x?}: three tokens of its {stage:?} stage have no answer",
                    request.setup
                ),
            ),
        };
        wire.witness.saw(trap, why);
    }
}
