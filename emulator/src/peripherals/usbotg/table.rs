//! The buffer descriptor table in RAM (K20 manual, USB OTG controller, "Buffer Descriptor Table" and "Buffer
//! Descriptors"): 16 endpoints, two directions, an even and an odd bank, eight bytes each.

use crate::cpu::Ram;

const OWN: u32 = 1 << 7;
const DATA1: u32 = 1 << 6;
const KEEP: u32 = 1 << 5;
const NINC: u32 = 1 << 4;
const DTS: u32 = 1 << 3;
const BDT_STALL: u32 = 1 << 2;

/// Packet identifiers as the controller writes them back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pid {
    Out = 0x1,
    In = 0x9,
    Setup = 0xD,
}

/// Which of the table's 64 descriptors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    pub endpoint: u8,
    pub transmit: bool,
    pub odd: bool,
}

impl Place {
    /// The descriptor's address in a table that begins at `table`.
    pub fn address(self, table: u32) -> u32 {
        table | (self.index() as u32) << 3
    }

    /// The descriptor's number in the table.
    pub fn index(self) -> usize {
        usize::from(self.endpoint) << 2 | usize::from(self.transmit) << 1 | usize::from(self.odd)
    }

    /// As STAT shows it: ENDP, TX, ODD.
    pub fn as_stat(self) -> u8 {
        (self.index() as u8) << 2
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let direction = if self.transmit { "transmit" } else { "receive" };
        let bank = if self.odd { "odd" } else { "even" };
        write!(
            f,
            "the {bank} {direction} descriptor of endpoint {}",
            self.endpoint
        )
    }
}

/// A descriptor as it is in RAM.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Descriptor {
    pub status: u32,
    pub buffer: u32,
}

impl Descriptor {
    /// Reads the descriptor at `address`; `None` outside the SRAM.
    pub fn read(address: u32, ram: &Ram) -> Option<Descriptor> {
        Some(Descriptor {
            status: ram.word(address)?,
            buffer: ram.word(address + 4)?,
        })
    }

    /// Whether it is the controller's.
    pub fn is_owned(self) -> bool {
        self.status & OWN != 0
    }

    /// The toggle it sends or expects.
    pub fn data1(self) -> bool {
        self.status & DATA1 != 0
    }

    /// Whether the controller keeps it after a token.
    pub fn keeps(self) -> bool {
        self.status & KEEP != 0
    }

    /// Whether all bytes go to or come from one address.
    pub fn is_fifo(self) -> bool {
        self.status & NINC != 0
    }

    /// Whether a packet with the other toggle is dropped.
    pub fn synchronises(self) -> bool {
        self.status & DTS != 0
    }

    /// Whether a token that would use it is stalled.
    pub fn stalls(self) -> bool {
        self.status & BDT_STALL != 0
    }

    /// BC: bytes to send, or room for those that come.
    pub fn count(self) -> usize {
        (self.status >> 16 & 0x3FF) as usize
    }

    /// The status word after a token: no longer the controller's.
    pub fn completed(self, pid: Pid, length: usize) -> u32 {
        self.status & DATA1 | (pid as u32) << 2 | (length as u32) << 16
    }
}
