//! A transaction on the sensor bus, from START to STOP.

use std::fmt;

use crate::journal::I2cByte;

/// One direction of it, from an address to the next or to the end.
#[derive(Debug, Clone, Default)]
struct Part {
    address: u8,
    answered: bool,
    bytes: Vec<u8>,
    /// A written byte that was not acknowledged.
    refused: bool,
}

/// What has crossed the bus since the START.
#[derive(Debug, Clone, Default)]
pub(super) struct Transaction {
    parts: Vec<Part>,
}

impl Transaction {
    /// Takes in a byte.
    pub fn byte(&mut self, kind: I2cByte, byte: u8, acknowledged: bool) {
        if kind == I2cByte::Address || self.parts.is_empty() {
            self.parts.push(Part {
                address: byte,
                answered: acknowledged,
                ..Part::default()
            });
        }
        if kind != I2cByte::Address
            && let Some(part) = self.parts.last_mut()
        {
            part.bytes.push(byte);
            part.refused |= kind == I2cByte::Written && !acknowledged;
        }
    }
}

impl fmt::Display for Transaction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut before = None;
        for part in &self.parts {
            let target = part.address >> 1;
            if before != Some(target) {
                let gap = if before.is_some() { " " } else { "" };
                write!(f, "{gap}0x{target:02x}")?;
            }
            before = Some(target);
            let direction = if part.address & 1 == 0 {
                "write"
            } else {
                "read"
            };
            write!(f, " {direction}")?;
            if !part.answered {
                write!(f, ", no answer")?;
            }
            if !part.bytes.is_empty() {
                let bytes: Vec<String> = part.bytes.iter().map(|b| format!("{b:02x}")).collect();
                write!(f, " [{}]", bytes.join(" "))?;
            }
            if part.refused {
                write!(f, ", refused")?;
            }
        }
        Ok(())
    }
}
