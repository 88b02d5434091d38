//! What happens on the board, for those who watch: the models note it, [`crate::board`] hands it to its watchers.
//!
//! Nothing is noted while nobody watches, and nothing that is noted influences what happens.

use crate::time::Ticks;
use crate::usb_transaction::{Answer, Token};

/// Something that happened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Happening {
    /// The processor has read or written a register of a peripheral.
    Register {
        /// Its address.
        address: u32,
        /// Bytes of the access.
        width: u8,
        /// What was read, or is written; `None` for a bus fault.
        value: Option<u32>,
        /// Whether it was written.
        store: bool,
    },
    /// A byte has crossed the sensor bus.
    I2cByte {
        /// What kind of byte.
        kind: I2cByte,
        /// Its value.
        byte: u8,
        /// Whether the receiver has acknowledged it.
        acknowledged: bool,
        /// How long one bit took.
        bit: Ticks,
    },
    /// A STOP has ended, which took as long as one bit.
    I2cStop {
        /// How long one bit takes.
        bit: Ticks,
    },
    /// The sensor bus's wires have other levels, by somebody else than I2C0.
    Wires {
        /// The clock.
        scl: bool,
        /// The data.
        sda: bool,
    },
    /// A USB transaction.
    Usb {
        /// The device's address.
        address: u8,
        /// The endpoint's number.
        endpoint: u8,
        /// What the host began with.
        token: Token,
        /// What the device has answered.
        answer: Answer,
    },
    /// A USB frame has begun.
    UsbFrame(u16),
    /// The host has reset the USB.
    UsbReset,
    /// The processor has entered an exception, by its number: 16 + n is interrupt n.
    Entered {
        /// The number.
        exception: u16,
        /// How long it waited since its line was raised, if it has a line.
        waited: Option<Ticks>,
    },
    /// The processor has left an exception.
    Left {
        /// Its number.
        exception: u16,
    },
    /// The processor has fallen asleep, or is awake again.
    Asleep(bool),
    /// The chip was reset.
    Reset,
}

/// The kinds of bytes on the sensor bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum I2cByte {
    /// The address after a START or a repeated START; its lowest bit is 1 for reading.
    Address,
    /// A byte from the master.
    Written,
    /// A byte from the target.
    Read,
}

/// Notes of what happened since they were last taken. A copy begins switched off.
#[derive(Default)]
pub struct Journal(Option<Vec<(Ticks, Happening)>>);

impl Journal {
    /// Begins to take notes.
    pub fn switch_on(&mut self) {
        self.0.get_or_insert_default();
    }

    /// Whether notes are taken.
    pub fn is_on(&self) -> bool {
        self.0.is_some()
    }

    /// Notes what `happening` returns.
    pub fn note(&mut self, at: Ticks, happening: impl FnOnce() -> Happening) {
        if let Some(notes) = &mut self.0 {
            notes.push((at, happening()));
        }
    }

    /// Takes the notes.
    pub fn take(&mut self) -> Vec<(Ticks, Happening)> {
        self.0.as_mut().map(std::mem::take).unwrap_or_default()
    }
}

impl Clone for Journal {
    fn clone(&self) -> Journal {
        Journal::default()
    }
}

/// Notes are no state of the board.
impl std::fmt::Debug for Journal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Journal")
    }
}
