//! How the fused orientation is put on the wire, how often, and with which number.

use super::LINE_EVERY;
use crate::command::request::Format;
use crate::wire::frame::{self, Counts, Frame};
use crate::wire::{self, Decimals, Line, Provenance, Q30, Stamp, Status, Tag};

/// What the host has chosen, and the number of the next orientation.
#[derive(Clone, Debug)]
pub struct Stream {
    format: Format,
    every: u16,
    decimals: Decimals,
    sequence: u16,
}

impl Default for Stream {
    fn default() -> Self {
        Self {
            format: Format::default(),
            every: LINE_EVERY,
            decimals: Decimals::COURSE,
            sequence: 0,
        }
    }
}

impl Stream {
    /// As after power-on, but for the numbers: they go on.
    pub fn set_defaults(&mut self) {
        let sequence = self.sequence;
        *self = Self {
            sequence,
            ..Self::default()
        };
    }

    /// From now on like this, as often as is usual for it: frames with every sample.
    pub fn choose(&mut self, format: Format) {
        self.format = format;
        self.every = match format {
            Format::Text | Format::Timed => LINE_EVERY,
            Format::Binary | Format::Counts => 1,
        };
    }

    /// Which is chosen.
    pub fn format(&self) -> Format {
        self.format
    }

    /// So many samples lead to one line or frame.
    pub fn set_every(&mut self, samples: u16) {
        self.every = samples;
    }

    /// How many samples lead to one line or frame.
    pub fn every(&self) -> u16 {
        self.every
    }

    /// Of the quaternions in lines.
    pub fn set_decimals(&mut self, decimals: Decimals) {
        self.decimals = decimals;
    }

    /// Of the quaternions in lines.
    pub fn decimals(&self) -> Decimals {
        self.decimals
    }

    /// The fused orientation of these counts, ready at `micros` of device time: a line, or a frame.
    pub fn fused(
        &mut self,
        q: Q30,
        micros: u32,
        status: Status,
        counts: &Counts,
        emit: &mut impl FnMut(&Line),
    ) -> Option<Frame> {
        if self.format == Format::Text {
            emit(&wire::quaternion(Tag::Fused, q, self.decimals));
            return None;
        }
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        let stamp = Stamp { sequence, micros };
        let provenance = Provenance { stamp, status };
        match self.format {
            Format::Text | Format::Timed => {
                emit(&wire::timed(q, stamp, self.decimals));
                None
            }
            Format::Binary => Some(frame::orientation(q, provenance)),
            Format::Counts => Some(frame::orientation_and_counts(q, provenance, counts)),
        }
    }
}
