//! Direct memory access at work: who asks, and the way to memories and registers.

use super::Chip;
use crate::peripherals::dma::Bus;
use crate::peripherals::ftfl::FLEXRAM_BASE;
use crate::time::{self, NEVER, Ticks};

/// Core cycles of a minor loop beside its accesses, and of each access: the order of what the manual's chapter on the
/// controller gives as its performance.
const OVERHEAD: u64 = 8;
const ACCESS: u64 = 2;

impl Chip {
    /// When the controller is free to serve the next channel; NEVER while none is asked.
    pub(super) fn next_transfer(&self) -> Ticks {
        if self.dma.next_channel(self.asked_channels()).is_some() {
            self.dma_free_at
        } else {
            NEVER
        }
    }

    fn asked_channels(&self) -> u32 {
        match self.dma.listening() {
            0 => 0,
            listening => self
                .dma_mux
                .requested(listening, |source| self.asks(source)),
        }
    }

    /// Whether a request source asks (K20 manual, chapter 3, "DMA MUX request sources").
    fn asks(&self, source: u8) -> bool {
        let n = usize::from(source);
        match source {
            2..=7 => self.communication.uarts[(n - 2) / 2].dma_request(n % 2 == 1),
            16 | 17 => self.communication.spi.dma_request(source == 17),
            22 => self.i2c.dma_request(),
            23 => self.communication.i2c1.dma_request(),
            24..=31 => self.timers.flex[0].dma_request(n - 24),
            32 | 33 => self.timers.flex[1].dma_request(n - 32),
            34 | 35 => self.timers.flex[2].dma_request(n - 34),
            40 | 41 => self.analog.converters[n - 40].dma_request(),
            48 => self.timers.delay.dma_request(),
            49..=53 => self.pins.dma_request(n - 49),
            _ => false,
        }
    }

    /// Sources whose flag the transfer itself clears.
    fn served(&mut self, source: u8) {
        let n = usize::from(source);
        match source {
            24..=31 => self.timers.flex[0].dma_done(n - 24),
            32 | 33 => self.timers.flex[1].dma_done(n - 32),
            34 | 35 => self.timers.flex[2].dma_done(n - 34),
            48 => self.timers.delay.dma_done(),
            49..=53 => self.pins.dma_done(n - 49),
            _ => {}
        }
    }

    /// Serves a channel, if one is asked and the controller is free.
    pub(super) fn transfer(&mut self) {
        if self.now < self.dma_free_at {
            return;
        }
        let asked = self.asked_channels();
        let Some(channel) = self.dma.next_channel(asked) else {
            return;
        };
        // The controller works on the chip that it is a part of.
        let mut dma = std::mem::take(&mut self.dma);
        let accesses = dma.serve(channel, self);
        self.dma = dma;
        if asked >> channel & 1 != 0 {
            self.served(self.dma_mux.source(channel));
            self.dma_mux.served(channel);
        }
        let cycles = OVERHEAD + ACCESS * u64::from(accesses);
        self.dma_free_at = self.now + time::of_cycles(cycles, self.core_hz());
    }
}

impl Bus for Chip {
    fn read(&mut self, address: u32, width: u8) -> Option<u32> {
        let flash = || {
            let at = address as usize;
            let bytes = self.flash.memory.program.get(at..at + usize::from(width))?;
            Some(
                bytes
                    .iter()
                    .rev()
                    .fold(0, |word, &byte| word << 8 | u32::from(byte)),
            )
        };
        match address >> 28 {
            0 if self.flash.hides_flash() => Chip::read(self, address, width),
            0 => flash(),
            1 if address < FLEXRAM_BASE + 0x1000 => Chip::read(self, address, width),
            4 => Chip::read(self, address, width),
            _ => {
                let bytes = self.ram.bytes(address, usize::from(width))?;
                Some(
                    bytes
                        .iter()
                        .rev()
                        .fold(0, |word, &byte| word << 8 | u32::from(byte)),
                )
            }
        }
    }

    fn write(&mut self, address: u32, width: u8, value: u32) -> bool {
        match address >> 28 {
            0 => false,
            1 if address < FLEXRAM_BASE + 0x1000 => Chip::write(self, address, width, value),
            4 => Chip::write(self, address, width, value),
            _ => self
                .ram
                .set_bytes(address, &value.to_le_bytes()[..usize::from(width)]),
        }
    }
}
