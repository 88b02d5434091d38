//! Periodic interrupt timer (K20 manual, chapter 40): four 32-bit down-counters on the bus clock.

use crate::time::{self, NEVER, Ticks};

const MDIS: u32 = 1 << 1;
const TEN: u32 = 1 << 0;
const TIE: u32 = 1 << 1;

#[derive(Debug, Clone, Copy, Default)]
struct Channel {
    load: u32,
    control: u32,
    flag: bool,
    /// When the counter next passes zero, while it runs.
    expires: Option<Ticks>,
    /// It has passed zero since [`IntervalTimer::take_expired`] was last asked.
    expired: bool,
}

/// The timer.
#[derive(Debug, Clone)]
pub struct IntervalTimer {
    mcr: u32,
    channels: [Channel; 4],
}

impl IntervalTimer {
    /// The state after reset: module disabled.
    pub fn new() -> IntervalTimer {
        IntervalTimer {
            mcr: MDIS,
            channels: [Channel::default(); 4],
        }
    }

    /// When a counter next passes zero.
    pub fn next_event(&self) -> Ticks {
        self.channels
            .iter()
            .filter_map(|channel| channel.expires)
            .min()
            .unwrap_or(NEVER)
    }

    /// Lets every counter that has passed zero by `now` raise its flag and start over.
    pub fn advance(&mut self, now: Ticks, bus_hz: u32) {
        for channel in &mut self.channels {
            while let Some(at) = channel.expires.filter(|&at| at <= now) {
                (channel.flag, channel.expired) = (true, true);
                channel.expires = Some(at + time::of_cycles(u64::from(channel.load) + 1, bus_hz));
            }
        }
    }

    /// Channels that have passed zero since this was last asked: they trigger DMA channels of the same number.
    pub fn take_expired(&mut self) -> impl Iterator<Item = usize> {
        let channels = (0..).zip(&mut self.channels);
        channels.filter_map(|(n, channel)| std::mem::take(&mut channel.expired).then_some(n))
    }

    /// Whether channel `n` asks for its interrupt.
    pub fn interrupt(&self, n: usize) -> bool {
        self.channels[n].flag && self.channels[n].control & TIE != 0
    }

    /// Reads a 32-bit register.
    pub fn read(&self, offset: u32, now: Ticks, bus_hz: u32) -> u32 {
        let Some(channel) = IntervalTimer::channel(offset) else {
            return self.mcr;
        };
        let channel = &self.channels[channel];
        match offset & 0xF {
            0x0 => channel.load,
            0x4 => channel.expires.map_or(0, |at| {
                (u128::from(at.saturating_sub(now)) * u128::from(bus_hz) / u128::from(time::SECOND))
                    as u32
            }),
            0x8 => channel.control,
            _ => u32::from(channel.flag),
        }
    }

    /// Writes a 32-bit register.
    pub fn write(&mut self, offset: u32, value: u32, now: Ticks, bus_hz: u32) {
        let Some(index) = IntervalTimer::channel(offset) else {
            self.mcr = value;
            return;
        };
        let enabled = self.mcr & MDIS == 0;
        let channel = &mut self.channels[index];
        match offset & 0xF {
            // A new value is loaded at the next expiry, or when the channel is enabled again (40.4.1.1).
            0x0 => channel.load = value,
            0x8 => {
                let started = value & TEN != 0 && channel.control & TEN == 0;
                channel.control = value;
                if value & TEN == 0 || !enabled {
                    channel.expires = None;
                } else if started {
                    channel.expires =
                        Some(now + time::of_cycles(u64::from(channel.load) + 1, bus_hz));
                }
            }
            0xC => channel.flag &= value & 1 == 0,
            _ => {}
        }
    }

    fn channel(offset: u32) -> Option<usize> {
        (0x100..0x140)
            .contains(&offset)
            .then(|| (offset as usize - 0x100) / 0x10)
    }
}

impl Default for IntervalTimer {
    fn default() -> IntervalTimer {
        IntervalTimer::new()
    }
}
