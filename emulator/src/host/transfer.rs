//! What a driver asks of the bus, and how it ends.

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

    /// wLength.
    pub fn length(&self) -> usize {
        usize::from(u16::from_le_bytes([self.setup[6], self.setup[7]]))
    }

    /// wValue.
    pub fn value(&self) -> u16 {
        u16::from_le_bytes([self.setup[2], self.setup[3]])
    }

    /// wIndex.
    pub fn index(&self) -> u16 {
        u16::from_le_bytes([self.setup[4], self.setup[5]])
    }

    /// Whether its data stage goes to the host.
    pub fn reads(&self) -> bool {
        self.setup[0] & 0x80 != 0
    }
}

/// What a driver hands to the bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Transfer {
    /// A request on endpoint 0.
    Control(Request),
    /// Packets from IN endpoint `number`, joined until a short one or until `length` bytes are there.
    In {
        /// The endpoint's number.
        number: u8,
        /// Most bytes to take.
        length: usize,
    },
    /// Bytes for OUT endpoint `number`, split into packets.
    Out {
        /// The endpoint's number.
        number: u8,
        /// What to send.
        data: Vec<u8>,
        /// Whether an empty packet follows when the last one is full.
        closed: bool,
    },
}

/// Names a transfer until it ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Ticket(pub(super) u64);

/// How a transfer ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// Done; with what was read.
    Done(Vec<u8>),
    /// Refused by the device.
    Stalled,
    /// Something is wrong with the device.
    Failed(Failure),
}

/// What is wrong with a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// Three transactions in turn had no answer.
    NoAnswer,
    /// Nothing but NAK for five seconds.
    NotReady,
    /// More data than fits the packet or the transfer.
    TooMuch,
    /// A handshake where data is due, or the other way round.
    OutOfPlace,
    /// The configuration has no such endpoint.
    NoEndpoint,
    /// It was unplugged, reset or configured anew.
    Gone,
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Failure::NoAnswer => "no answer to three tries",
            Failure::NotReady => "nothing but NAK for 5 s",
            Failure::TooMuch => "more data than there is room for",
            Failure::OutOfPlace => "an answer out of place",
            Failure::NoEndpoint => "the configuration has no such endpoint",
            Failure::Gone => "the device is gone",
        })
    }
}
