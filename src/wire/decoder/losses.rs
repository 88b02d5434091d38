//! What a stream has lost.

use crate::wire::frame::Damage;

/// What was thrown away, and what never came.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// Bytes that were part of nothing; the ends of lines and the zeros around frames are not counted.
    pub bytes: u64,
    /// Lines and frames whose checksum was wrong. Their bytes are among those above, as are those of
    /// the next.
    pub damaged: u32,
    /// What was no line and no frame, and what claimed to be an orientation and is none.
    pub malformed: u32,
    /// Orientations with a sequence number between two that came.
    pub missing: u32,
    /// Sequence numbers that went back or stayed: the board has started again.
    pub restarts: u32,
    last: Option<u16>,
}

impl Losses {
    pub(super) const fn none() -> Self {
        Self {
            bytes: 0,
            damaged: 0,
            malformed: 0,
            missing: 0,
            restarts: 0,
            last: None,
        }
    }

    /// So many bytes are thrown away.
    pub(super) fn refuse(&mut self, damage: Damage, bytes: usize) {
        self.bytes += bytes as u64;
        let count = match damage {
            Damage::Malformed => &mut self.malformed,
            Damage::Checksum => &mut self.damaged,
        };
        *count = count.saturating_add(1);
    }

    /// An orientation with this number has come. Up to half of the numbers may be missing between two.
    pub(super) fn follow(&mut self, sequence: u16) {
        if let Some(last) = self.last {
            match sequence.wrapping_sub(last) {
                ahead @ 1..=0x7FFF => {
                    self.missing = self.missing.saturating_add(u32::from(ahead) - 1);
                }
                _ => self.restarts = self.restarts.saturating_add(1),
            }
        }
        self.last = Some(sequence);
    }
}
