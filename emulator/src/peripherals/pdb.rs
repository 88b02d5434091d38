//! Programmable delay block (K20 manual, chapter "Programmable Delay Block (PDB)"): a counter that triggers the
//! converters after their delays.

use super::clocks::Clocks;
use crate::time::{self, NEVER, Ticks};

const SC: u32 = 0x00;
const MOD: u32 = 0x04;
const CNT: u32 = 0x08;
const IDLY: u32 = 0x0C;
/// Channel registers: control, status, two delays, for each of two converters.
const CHANNELS: [u32; 2] = [0x10, 0x38];
const END: u32 = 0x1A0;

const LDOK: u32 = 1 << 0;
const CONT: u32 = 1 << 1;
const PDBIE: u32 = 1 << 5;
const PDBIF: u32 = 1 << 6;
const PDBEN: u32 = 1 << 7;
const DMAEN: u32 = 1 << 15;
const SWTRIG: u32 = 1 << 16;

/// A converter's trigger: (converter, pre-trigger).
pub type Trigger = (usize, usize);

/// The block.
#[derive(Debug, Clone)]
pub struct DelayBlock {
    control: u32,
    registers: [u32; END as usize / 4],
    /// Values in effect; the registers are buffered until LDOK.
    loaded: [u32; END as usize / 4],
    since: Option<Ticks>,
    seen: Ticks,
    hz: u32,
}

impl DelayBlock {
    /// The state after reset.
    pub fn new() -> DelayBlock {
        let mut registers = [0; END as usize / 4];
        registers[MOD as usize / 4] = 0xFFFF;
        registers[IDLY as usize / 4] = 0xFFFF;
        DelayBlock {
            control: 0,
            registers,
            loaded: registers,
            since: None,
            seen: 0,
            hz: 0,
        }
    }

    fn at(&self, count: u32) -> Ticks {
        self.since.map_or(NEVER, |since| {
            since + time::of_cycles(u64::from(count), self.hz)
        })
    }

    fn loaded(&self, register: u32) -> u32 {
        self.loaded[register as usize / 4] & 0xFFFF
    }

    /// Places of the counter at which something happens, in order of the registers.
    fn places(&self) -> impl Iterator<Item = (u32, Option<Trigger>)> {
        let triggers = (0..2).flat_map(move |converter| {
            let base = CHANNELS[converter];
            let control = self.loaded[base as usize / 4];
            (0..2).filter_map(move |pre| {
                let enabled = control >> pre & 1 != 0;
                let delayed = control >> (8 + pre) & 1 != 0;
                let delay = if delayed {
                    self.loaded(base + 8 + 4 * pre as u32)
                } else {
                    0
                };
                enabled.then_some((delay, Some((converter, pre))))
            })
        });
        triggers
            .chain([(self.loaded(IDLY), None)])
            .filter(|&(count, _)| count <= self.loaded(MOD))
    }

    /// When something happens next.
    pub fn next_event(&self) -> Ticks {
        let end = self.at(self.loaded(MOD) + 1);
        self.places()
            .map(|(count, _)| self.at(count + 1))
            .filter(|&at| at > self.seen)
            .fold(end, Ticks::min)
    }

    /// Lets happen what is due; returns the triggers that fire.
    pub fn advance(&mut self, now: Ticks) -> Vec<Trigger> {
        let mut fired = Vec::new();
        while self.next_event() <= now {
            let at = self.next_event();
            let due: Vec<_> = self
                .places()
                .filter(|&(count, _)| self.at(count + 1) == at)
                .collect();
            for (_, trigger) in due {
                match trigger {
                    Some(trigger) => fired.push(trigger),
                    None => self.control |= PDBIF,
                }
            }
            self.seen = at;
            if at == self.at(self.loaded(MOD) + 1) {
                self.since = (self.control & CONT != 0).then_some(at);
            }
        }
        fired
    }

    /// Whether the delay has passed and asks for its interrupt.
    pub fn interrupt(&self) -> bool {
        self.control & (PDBIF | PDBIE | DMAEN) == PDBIF | PDBIE
    }

    /// Whether it asks for DMA instead.
    pub fn dma_request(&self) -> bool {
        self.control & (PDBIF | DMAEN) == PDBIF | DMAEN
    }

    /// A DMA transfer has ended, which clears the flag.
    pub fn dma_done(&mut self) {
        self.control &= !PDBIF;
    }

    /// Reads a 32-bit register.
    pub fn read(&self, offset: u32, now: Ticks) -> u32 {
        match offset {
            SC => self.control,
            CNT => self.since.map_or(0, |since| {
                super::clocks::cycles_in(now.saturating_sub(since), self.hz) as u32
            }),
            _ => self
                .registers
                .get(offset as usize / 4)
                .copied()
                .unwrap_or(0),
        }
    }

    /// Writes a 32-bit register.
    pub fn write(&mut self, offset: u32, value: u32, clocks: &Clocks) {
        match offset {
            SC => {
                let flag = self.control & PDBIF & value;
                self.control = value & !(LDOK | SWTRIG | PDBIF) | flag;
                let factor = [1, 10, 20, 40][(value >> 2 & 3) as usize];
                self.hz = (clocks.bus_hz >> (value >> 12 & 7)) / factor;
                if value & PDBEN == 0 {
                    self.since = None;
                }
                if value & LDOK != 0 {
                    self.loaded = self.registers;
                }
                // Trigger source 15 is software; the other sources are not wired up.
                if value & (SWTRIG | PDBEN) == SWTRIG | PDBEN && value >> 8 & 0xF == 15 {
                    (self.since, self.seen) = (Some(clocks.now), clocks.now);
                }
            }
            _ => {
                if let Some(register) = self.registers.get_mut(offset as usize / 4) {
                    *register = value;
                }
                // A channel's control and status are not buffered.
                if CHANNELS
                    .iter()
                    .any(|&base| offset == base || offset == base + 4)
                {
                    self.loaded[offset as usize / 4] = value;
                }
            }
        }
    }
}

impl Default for DelayBlock {
    fn default() -> DelayBlock {
        DelayBlock::new()
    }
}
