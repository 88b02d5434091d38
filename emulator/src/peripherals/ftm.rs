//! FlexTimer (K20 manual, chapter "FlexTimer Module (FTM)"): the counter, PWM, output compare and input capture.
//!
//! Nothing is counted step by step: the counter's value, and when it next passes a place, follow from the moment it
//! started. Pairs of channels, dead time, faults and quadrature decoding are registers that only keep what is written.

use super::clocks::{Clocks, cycles_in};
use crate::time::{self, NEVER, Ticks};

const SC: u32 = 0x00;
const CNT: u32 = 0x04;
const MOD: u32 = 0x08;
const C0SC: u32 = 0x0C;
const CNTIN: u32 = 0x4C;
const STATUS: u32 = 0x50;
const MODE: u32 = 0x54;
const CONF: u32 = 0x84;
const PWMLOAD: u32 = 0x98;

const TOF: u32 = 1 << 7;
const TOIE: u32 = 1 << 6;
const CPWMS: u32 = 1 << 5;
const WPDIS: u32 = 1 << 2;

const CHF: u32 = 1 << 7;
const CHIE: u32 = 1 << 6;
const MSB: u32 = 1 << 5;
const MSA: u32 = 1 << 4;
const ELSB: u32 = 1 << 3;
const ELSA: u32 = 1 << 2;
const DMA: u32 = 1 << 0;

#[derive(Debug, Clone, Copy, Default)]
struct Channel {
    control: u32,
    value: u32,
    /// A value that waits for the end of the period.
    next_value: Option<u32>,
    flag: bool,
    /// Matches up to this moment have been looked at.
    seen: Ticks,
    /// Level of an output that compares.
    level: bool,
}

/// A pulse train, as an oscilloscope on the pin would show it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pulses {
    /// From one rising edge to the next.
    pub period: Ticks,
    /// How long it is high in each.
    pub high: Ticks,
}

/// One timer.
#[derive(Debug, Clone)]
pub struct FlexTimer {
    sc: u32,
    modulo: u32,
    next_modulo: Option<u32>,
    initial: u32,
    overflowed: bool,
    seen: Ticks,
    channels: Vec<Channel>,
    /// When the counter was at `initial`, while it runs; otherwise what it stands at.
    since: Ticks,
    stopped_at: u32,
    /// Frequency of the counter; 0 while it stands still.
    hz: u32,
    rest: [u32; 0x14],
}

impl FlexTimer {
    /// The state after reset of a timer with this many channels.
    pub fn new(channels: usize) -> FlexTimer {
        let mut rest = [0; 0x14];
        rest[(MODE - CNTIN) as usize / 4] = WPDIS;
        FlexTimer {
            sc: 0,
            modulo: 0,
            next_modulo: None,
            initial: 0,
            overflowed: false,
            seen: 0,
            channels: vec![Channel::default(); channels],
            since: 0,
            stopped_at: 0,
            hz: 0,
            rest,
        }
    }

    /// Counts in a period: up and down again where pulses are aligned to their centre.
    fn period(&self) -> u64 {
        let span = u64::from(self.modulo.wrapping_sub(self.initial) & 0xFFFF);
        if self.sc & CPWMS != 0 {
            (2 * span).max(1)
        } else if self.modulo == 0 && self.initial == 0 {
            0x1_0000
        } else {
            span + 1
        }
    }

    /// Counts since the counter was at its initial value.
    fn counted(&self, now: Ticks) -> u64 {
        cycles_in(now.saturating_sub(self.since), self.hz)
    }

    fn counter(&self, now: Ticks) -> u32 {
        if self.hz == 0 {
            return self.stopped_at;
        }
        let phase = self.counted(now) % self.period();
        let phase = if self.sc & CPWMS != 0 {
            phase.min(self.period() - phase)
        } else {
            phase
        };
        (self.initial + phase as u32) & 0xFFFF
    }

    /// The first moment after `from` at which the counter has come to `phase` of its period.
    fn next_at(&self, phase: u64, from: Ticks) -> Ticks {
        let period = self.period();
        if self.hz == 0 || phase >= period {
            return NEVER;
        }
        let done = self.counted(from);
        let ahead = (phase + period - done % period) % period;
        let ahead = if ahead == 0 { period } else { ahead };
        self.since + time::of_cycles(done + ahead, self.hz)
    }

    /// The end of the period: where the counter overflows and buffered values are taken over.
    fn next_overflow(&self, from: Ticks) -> Ticks {
        self.next_at(
            if self.sc & CPWMS != 0 {
                self.period() / 2
            } else {
                0
            },
            from,
        )
    }

    fn next_match(&self, channel: &Channel, from: Ticks) -> Ticks {
        let capturing = channel.control & (MSB | MSA) == 0;
        let connected = channel.control & (MSB | MSA | ELSB | ELSA) != 0;
        if (capturing && self.sc & CPWMS == 0) || !connected {
            return NEVER;
        }
        let phase = u64::from(channel.value.wrapping_sub(self.initial) & 0xFFFF);
        let up = self.next_at(phase, from);
        if self.sc & CPWMS != 0 && phase > 0 {
            return up.min(self.next_at(self.period().saturating_sub(phase), from));
        }
        up
    }

    /// When something happens that has to be noticed at once.
    pub fn next_event(&self) -> Ticks {
        let mut at = NEVER;
        let buffered = self.next_modulo.is_some()
            || self
                .channels
                .iter()
                .any(|channel| channel.next_value.is_some());
        if buffered || self.sc & TOIE != 0 && !self.overflowed {
            at = at.min(self.next_overflow(self.seen));
        }
        for channel in &self.channels {
            if channel.control & CHIE != 0 && !channel.flag {
                at = at.min(self.next_match(channel, channel.seen));
            }
        }
        at
    }

    /// Notices what has happened up to now.
    pub fn advance(&mut self, now: Ticks) {
        let overflow = self.next_overflow(self.seen);
        for n in 0..self.channels.len() {
            let channel = self.channels[n];
            let matched = self.next_match(&channel, channel.seen);
            if matched <= now {
                let channel = &mut self.channels[n];
                channel.flag = true;
                if channel.control & (MSB | MSA) == MSA {
                    channel.level = match channel.control & (ELSB | ELSA) {
                        ELSA => !channel.level,
                        ELSB => false,
                        _ => true,
                    };
                }
            }
            self.channels[n].seen = now;
        }
        if overflow <= now {
            self.overflowed = true;
            self.take_over(overflow);
        }
        self.seen = now;
    }

    /// Buffered values are taken over when the period ends.
    fn take_over(&mut self, at: Ticks) {
        if let Some(modulo) = self.next_modulo.take() {
            // A new period begins here; the phase must not jump.
            self.since = at;
            self.modulo = modulo;
        }
        for channel in &mut self.channels {
            if let Some(value) = channel.next_value.take() {
                channel.value = value;
            }
        }
    }

    /// Whether overflow or a channel asks for the timer's interrupt.
    pub fn interrupt(&self) -> bool {
        self.overflowed && self.sc & TOIE != 0
            || self
                .channels
                .iter()
                .any(|channel| channel.flag && channel.control & (CHIE | DMA) == CHIE)
    }

    /// Whether channel `n` asks for DMA.
    pub fn dma_request(&self, n: usize) -> bool {
        self.channels
            .get(n)
            .is_some_and(|channel| channel.flag && channel.control & (CHIE | DMA) == CHIE | DMA)
    }

    /// A DMA transfer for channel `n` has ended, which clears its flag.
    pub fn dma_done(&mut self, n: usize) {
        if let Some(channel) = self.channels.get_mut(n) {
            channel.flag = false;
        }
    }

    /// An edge on the pin of channel `n`.
    pub fn edge(&mut self, n: usize, rising: bool, now: Ticks) {
        let counter = self.counter(now);
        let Some(channel) = self.channels.get_mut(n) else {
            return;
        };
        let wanted = if rising { ELSA } else { ELSB };
        if channel.control & (MSB | MSA) == 0 && channel.control & wanted != 0 {
            channel.value = counter;
            channel.flag = true;
        }
    }

    /// What channel `n` puts out, if it makes pulses.
    pub fn pulses(&self, n: usize) -> Option<Pulses> {
        let channel = self.channels.get(n)?;
        if self.hz == 0
            || channel.control & MSB == 0 && self.sc & CPWMS == 0
            || channel.control & (ELSB | ELSA) == 0
        {
            return None;
        }
        let value = u64::from(channel.value.wrapping_sub(self.initial) & 0xFFFF);
        let width = if self.sc & CPWMS != 0 {
            2 * value
        } else {
            value
        }
        .min(self.period());
        let high = if channel.control & ELSA == 0 {
            width
        } else {
            self.period() - width
        };
        Some(Pulses {
            period: time::of_cycles(self.period(), self.hz),
            high: time::of_cycles(high, self.hz),
        })
    }

    /// Level of channel `n`'s pin.
    pub fn level(&self, n: usize, now: Ticks) -> bool {
        let Some(channel) = self.channels.get(n) else {
            return false;
        };
        if self.pulses(n).is_none() {
            return channel.level;
        }
        let counter = self.counter(now).wrapping_sub(self.initial) & 0xFFFF;
        let below = counter < channel.value.wrapping_sub(self.initial) & 0xFFFF;
        below == (channel.control & ELSA == 0)
    }

    fn channel_at(&self, offset: u32) -> Option<(usize, bool)> {
        let n = offset.checked_sub(C0SC)? as usize / 8;
        (n < self.channels.len() && offset < CNTIN).then_some((n, (offset - C0SC) % 8 == 4))
    }

    /// Reads a 32-bit register.
    pub fn read(&mut self, offset: u32, now: Ticks) -> u32 {
        self.advance(now);
        if let Some((n, value)) = self.channel_at(offset) {
            let channel = &self.channels[n];
            return if value {
                channel.value
            } else {
                channel.control | if channel.flag { CHF } else { 0 }
            };
        }
        match offset {
            SC => self.sc | if self.overflowed { TOF } else { 0 },
            CNT => self.counter(now),
            MOD => self.modulo,
            CNTIN => self.initial,
            STATUS => (0..)
                .zip(&self.channels)
                .map(|(n, channel)| u32::from(channel.flag) << n)
                .sum(),
            MODE..=PWMLOAD => self.rest[(offset - CNTIN) as usize / 4],
            _ => 0,
        }
    }

    /// Writes a 32-bit register.
    pub fn write(&mut self, offset: u32, value: u32, clocks: &Clocks) {
        let now = clocks.now;
        self.advance(now);
        if let Some((n, is_value)) = self.channel_at(offset) {
            let running = self.hz != 0;
            let channel = &mut self.channels[n];
            if is_value {
                // While the counter runs, a PWM channel takes a new value at the end of the period.
                let pwm = channel.control & MSB != 0;
                (channel.value, channel.next_value) = if running && pwm {
                    (channel.value, Some(value & 0xFFFF))
                } else {
                    (value & 0xFFFF, None)
                };
            } else {
                channel.flag &= value & CHF != 0;
                channel.control = value & 0x7D;
            }
            return;
        }
        match offset {
            SC => {
                self.overflowed &= value & TOF != 0;
                let counter = self.counter(now);
                self.sc = value & 0x7F;
                let source = match value >> 3 & 3 {
                    1 => clocks.bus_hz,
                    2 => clocks.fixed_hz,
                    _ => 0,
                };
                if source == 0 {
                    self.take_over(now);
                    self.stopped_at = counter;
                }
                self.hz = source >> (value & 7);
                self.begin_at(counter, now);
            }
            // Any write loads the initial value.
            CNT => {
                self.stopped_at = self.initial;
                self.begin_at(self.initial, now);
            }
            MOD if self.hz == 0 => self.modulo = value & 0xFFFF,
            MOD => self.next_modulo = Some(value & 0xFFFF),
            CNTIN => self.initial = value & 0xFFFF,
            // Each flag is cleared by a 0 written to it.
            STATUS => (0..)
                .zip(&mut self.channels)
                .for_each(|(n, channel)| channel.flag &= value >> n & 1 != 0),
            MODE..=CONF | PWMLOAD => self.rest[(offset - CNTIN) as usize / 4] = value,
            _ => {}
        }
    }

    /// Makes the counter go on from `counter` at `now`.
    fn begin_at(&mut self, counter: u32, now: Ticks) {
        if self.hz != 0 {
            let phase = u64::from(counter.wrapping_sub(self.initial) & 0xFFFF);
            self.since = now.saturating_sub(time::of_cycles(phase, self.hz));
        }
        self.seen = now;
    }
}
