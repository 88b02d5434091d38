//! DMA channel multiplexer (K20 manual, chapter 20): which peripheral asks which channel, and the periodic gate of the
//! first four.

const ENABLED: u8 = 1 << 7;
const TRIGGERED: u8 = 1 << 6;
/// From this source on a channel is always asked.
const ALWAYS: u8 = 54;

/// The multiplexer.
#[derive(Debug, Clone, Default)]
pub struct DmaMux {
    configuration: [u8; 16],
    /// The interval timer has opened the gate of a channel, until it was served.
    open: [bool; 4],
}

impl DmaMux {
    /// An interval timer's channel has expired.
    pub fn trigger(&mut self, channel: usize) {
        self.open[channel] = true;
    }

    /// Channels of `listening` that are asked, where `asks` tells whether a source does.
    pub fn requested(&self, listening: u32, asks: impl Fn(u8) -> bool) -> u32 {
        (0..16)
            .filter(|channel| listening >> channel & 1 != 0)
            .filter(|&channel| {
                let configuration = self.configuration[channel];
                let gated = configuration & TRIGGERED != 0 && channel < 4 && !self.open[channel];
                let source = configuration & 0x3F;
                configuration & ENABLED != 0 && !gated && (source >= ALWAYS || asks(source))
            })
            .map(|channel| 1 << channel)
            .sum()
    }

    /// The source that asks `channel`.
    pub fn source(&self, channel: usize) -> u8 {
        self.configuration[channel] & 0x3F
    }

    /// A channel was served.
    pub fn served(&mut self, channel: usize) {
        if let Some(open) = self.open.get_mut(channel) {
            *open = false;
        }
    }

    /// Reads an 8-bit register.
    pub fn read(&self, offset: u32) -> u32 {
        self.configuration
            .get(offset as usize)
            .copied()
            .unwrap_or(0)
            .into()
    }

    /// Writes an 8-bit register.
    pub fn write(&mut self, offset: u32, value: u8) {
        if let Some(register) = self.configuration.get_mut(offset as usize) {
            *register = value;
        }
    }
}
