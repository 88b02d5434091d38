//! Control transfers (USB 2.0, 8.5.3): setup, data and status stage, with their toggles and retries.

use crate::peripherals::usbotg::{Answer, Token};
use crate::time::{SECOND, Ticks};

/// A control request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Request {
    /// bmRequestType, bRequest, wValue, wIndex, wLength.
    pub setup: [u8; 8],
    /// What the host sends in the data stage of an OUT request.
    pub data: Vec<u8>,
}

impl Request {
    /// A request that reads up to `length` bytes.
    pub fn read(kind: u8, request: u8, value: u16, index: u16, length: u16) -> Request {
        Request {
            setup: Request::pack(kind, request, value, index, length),
            data: Vec::new(),
        }
    }

    /// A request that writes `data`.
    pub fn write(kind: u8, request: u8, value: u16, index: u16, data: &[u8]) -> Request {
        Request {
            setup: Request::pack(kind, request, value, index, data.len() as u16),
            data: data.to_vec(),
        }
    }

    fn pack(kind: u8, request: u8, value: u16, index: u16, length: u16) -> [u8; 8] {
        let ([v0, v1], [i0, i1], [l0, l1]) = (
            value.to_le_bytes(),
            index.to_le_bytes(),
            length.to_le_bytes(),
        );
        [kind, request, v0, v1, i0, i1, l0, l1]
    }

    fn length(&self) -> usize {
        usize::from(u16::from_le_bytes([self.setup[6], self.setup[7]]))
    }

    fn reads(&self) -> bool {
        self.setup[0] & 0x80 != 0
    }

    pub(super) fn is_set_configuration(&self) -> bool {
        self.setup[..2] == [0x00, 0x09]
    }
}

/// How a request ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// Done; with what was read.
    Done(Vec<u8>),
    /// Refused by the device.
    Stalled,
    /// The device did not answer.
    Failed(&'static str),
}

/// What one transaction did to the transfer.
pub(super) enum Progress {
    /// It went on; this many bytes crossed the wire.
    Moved(usize),
    /// NAK: try again soon.
    Wait,
    /// No handshake: try again in the next frame.
    Lost,
    /// It is over.
    Ended(Outcome),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    Setup,
    Data,
    Status,
}

/// A request on its way.
#[derive(Debug, Clone)]
pub(super) struct Transfer {
    request: Request,
    stage: Stage,
    toggle: bool,
    moved: usize,
    received: Vec<u8>,
    lost: u8,
    deadline: Ticks,
}

/// Endpoint 0's packet size; the tracker and Teensyduino both use the largest.
const PACKET: usize = 64;

impl Transfer {
    pub(super) fn new(request: Request, now: Ticks) -> Transfer {
        Transfer {
            request,
            stage: Stage::Setup,
            toggle: false,
            moved: 0,
            received: Vec::new(),
            lost: 0,
            deadline: now + 5 * SECOND,
        }
    }

    /// Does the transfer's next transaction.
    pub(super) fn step(
        &mut self,
        now: Ticks,
        complaints: &mut Vec<String>,
        mut transact: impl FnMut(&Token) -> Answer,
    ) -> Progress {
        let token = self.token();
        let answer = transact(&token);
        match (&answer, self.stage) {
            (Answer::Silence, _) => {
                self.lost += 1;
                // Three transactions without a handshake end a transfer (USB 2.0, 10.2.6).
                return if self.lost >= 3 {
                    Progress::Ended(Outcome::Failed("no answer to three tries"))
                } else {
                    Progress::Lost
                };
            }
            (Answer::Stall, _) => return Progress::Ended(Outcome::Stalled),
            (Answer::Nak, _) if now >= self.deadline => {
                return Progress::Ended(Outcome::Failed("nothing but NAK for 5 s"));
            }
            (Answer::Nak, _) => return Progress::Wait,
            _ => self.lost = 0,
        }
        match (answer, token, self.stage) {
            (Answer::Ack, _, Stage::Setup) => {
                self.toggle = true;
                self.stage = if self.request.length() == 0 {
                    Stage::Status
                } else {
                    Stage::Data
                };
                Progress::Moved(8)
            }
            (Answer::Data(data, toggle), _, Stage::Data) => {
                if toggle != self.toggle {
                    complaints.push(format!(
                        "control data with the wrong toggle in {:02x?}",
                        self.request.setup
                    ));
                    return Progress::Moved(data.len());
                }
                self.toggle = !self.toggle;
                self.received.extend_from_slice(&data);
                if data.len() < PACKET || self.received.len() >= self.request.length() {
                    self.stage = Stage::Status;
                }
                if self.received.len() > self.request.length() {
                    complaints.push(format!(
                        "more data than asked for in {:02x?}",
                        self.request.setup
                    ));
                }
                Progress::Moved(data.len())
            }
            (Answer::Ack, Token::Out(data, _), Stage::Data) => {
                self.toggle = !self.toggle;
                self.moved += data.len();
                if self.moved >= self.request.data.len() {
                    self.stage = Stage::Status;
                }
                Progress::Moved(data.len())
            }
            (Answer::Ack, _, Stage::Status) => {
                Progress::Ended(Outcome::Done(std::mem::take(&mut self.received)))
            }
            (Answer::Data(data, toggle), _, Stage::Status) => {
                if !data.is_empty() || !toggle {
                    complaints.push(format!(
                        "a status stage that is not empty DATA1 in {:02x?}",
                        self.request.setup
                    ));
                }
                Progress::Ended(Outcome::Done(Vec::new()))
            }
            _ => Progress::Ended(Outcome::Failed("an answer out of place")),
        }
    }

    fn token(&self) -> Token {
        match self.stage {
            Stage::Setup => Token::Setup(self.request.setup),
            Stage::Data if self.request.reads() => Token::In,
            Stage::Data => {
                let rest = &self.request.data[self.moved..];
                Token::Out(rest[..rest.len().min(PACKET)].to_vec(), self.toggle)
            }
            // The status stage runs against the data's direction and is always DATA1 (8.5.3.1).
            Stage::Status if self.request.reads() && self.request.length() > 0 => {
                Token::Out(Vec::new(), true)
            }
            Stage::Status => Token::In,
        }
    }
}
