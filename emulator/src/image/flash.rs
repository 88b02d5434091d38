//! The flash while an image is put together: its bytes, and which of them were programmed.

use super::{FLASH_SIZE, ImageError};

/// Erased flash into which an image is written once.
pub(super) struct Flash {
    bytes: Vec<u8>,
    programmed: Vec<bool>,
}

impl Flash {
    pub(super) fn erased() -> Self {
        Self {
            bytes: vec![0xFF; FLASH_SIZE],
            programmed: vec![false; FLASH_SIZE],
        }
    }

    /// Programs `data` from `address` on.
    ///
    /// A byte cannot be programmed twice: the second time would not change ones back, so a file that
    /// asks for it means something else than it says.
    pub(super) fn program(&mut self, address: u64, data: &[u8]) -> Result<(), ImageError> {
        let range = usize::try_from(address)
            .ok()
            .and_then(|begin| Some(begin..begin.checked_add(data.len())?))
            .filter(|range| range.end <= FLASH_SIZE)
            .ok_or(ImageError::OutsideFlash {
                address,
                length: data.len() as u64,
            })?;
        if let Some(again) = range.clone().find(|&at| self.programmed[at]) {
            return Err(ImageError::Overlap {
                address: again as u64,
            });
        }
        self.bytes[range.clone()].copy_from_slice(data);
        self.programmed[range].fill(true);
        Ok(())
    }

    /// One past the last programmed byte.
    pub(super) fn used(&self) -> usize {
        self.programmed
            .iter()
            .rposition(|&programmed| programmed)
            .map_or(0, |last| last + 1)
    }

    /// `N` bytes at `address`, if the image programs all of them.
    pub(super) fn bytes<const N: usize>(&self, address: u32) -> Option<[u8; N]> {
        let begin = usize::try_from(address).ok()?;
        let range = begin..begin.checked_add(N)?;
        let programmed = self.programmed.get(range.clone())?.iter().all(|&p| p);
        programmed.then(|| std::array::from_fn(|i| self.bytes[range.start + i]))
    }

    /// The little-endian word at `address`, if the image programs it.
    pub(super) fn word(&self, address: u32) -> Option<u32> {
        self.bytes(address).map(u32::from_le_bytes)
    }

    /// The little-endian halfword at `address`, if the image programs it.
    pub(super) fn halfword(&self, address: u32) -> Option<u16> {
        self.bytes(address).map(u16::from_le_bytes)
    }

    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}
