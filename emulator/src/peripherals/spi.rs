//! Serial peripheral interface (K20 manual, chapter "SPI (DSPI)") as a master: FIFOs of four, frames that take their
//! time, and what is wired between its pins.

use std::collections::VecDeque;

use super::clocks::Clocks;
use crate::time::{self, NEVER, Ticks};

const MCR: u32 = 0x00;
const TCR: u32 = 0x08;
const CTAR0: u32 = 0x0C;
const CTAR1: u32 = 0x10;
const SR: u32 = 0x2C;
const RSER: u32 = 0x30;
const PUSHR: u32 = 0x34;
const POPR: u32 = 0x38;
const TXFR0: u32 = 0x3C;
const RXFR0: u32 = 0x7C;

const MSTR: u32 = 1 << 31;
const MDIS: u32 = 1 << 14;
const HALT: u32 = 1 << 0;

const TCF: u32 = 1 << 31;
const TXRXS: u32 = 1 << 30;
const EOQF: u32 = 1 << 28;
const TFUF: u32 = 1 << 27;
const TFFF: u32 = 1 << 25;
const RFOF: u32 = 1 << 19;
const RFDF: u32 = 1 << 17;

const TFFF_DIRS: u32 = 1 << 24;
const RFDF_DIRS: u32 = 1 << 16;

/// Baud rate prescaler and scaler.
const PBR: [u64; 4] = [2, 3, 5, 7];
const BR: [u64; 16] = [
    2, 4, 6, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768,
];
const DEPTH: usize = 4;

/// What answers on SIN.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wire {
    /// Nothing: the line is pulled high.
    #[default]
    Open,
    /// SOUT, over a wire from pin 11 to pin 12.
    Loopback,
}

/// The interface.
#[derive(Debug, Clone)]
pub struct Spi {
    mcr: u32,
    tcr: u32,
    attributes: [u32; 2],
    flags: u32,
    rser: u32,
    transmit: VecDeque<u32>,
    receive: VecDeque<u32>,
    shifting: Option<(u32, Ticks)>,
    /// What is wired to SIN.
    pub wire: Wire,
    /// Frames sent, until somebody takes them.
    pub sent: Vec<u16>,
}

impl Spi {
    /// The state after reset.
    pub fn new() -> Spi {
        Spi {
            mcr: MDIS | HALT,
            tcr: 0,
            attributes: [0x7800_0000; 2],
            flags: 0,
            rser: 0,
            transmit: VecDeque::new(),
            receive: VecDeque::new(),
            shifting: None,
            wire: Wire::default(),
            sent: Vec::new(),
        }
    }

    /// A system reset; the wires stay as they are.
    pub fn reset(&mut self) {
        let (wire, sent) = (self.wire, std::mem::take(&mut self.sent));
        *self = Spi {
            wire,
            sent,
            ..Spi::new()
        };
    }

    fn status(&self) -> u32 {
        let level = |condition: bool, flag: u32| if condition { flag } else { 0 };
        self.flags
            | level(self.mcr & (HALT | MDIS) == 0, TXRXS)
            | level(self.transmit.len() < DEPTH && self.mcr & MDIS == 0, TFFF)
            | level(!self.receive.is_empty(), RFDF)
            | (self.transmit.len() as u32) << 12
            | (self.receive.len() as u32) << 4
    }

    /// Whether a flag asks for the interrupt.
    pub fn interrupt(&self) -> bool {
        let to_dma = if self.rser & TFFF_DIRS != 0 { TFFF } else { 0 }
            | if self.rser & RFDF_DIRS != 0 { RFDF } else { 0 };
        let flags = TCF | EOQF | TFUF | TFFF | RFOF | RFDF;
        self.status() & self.rser & flags & !to_dma != 0
    }

    /// Whether the transmitter (`true`) or the receiver asks for DMA.
    pub fn dma_request(&self, transmitter: bool) -> bool {
        let (flag, direction) = if transmitter {
            (TFFF, TFFF_DIRS)
        } else {
            (RFDF, RFDF_DIRS)
        };
        self.rser & (flag | direction) == flag | direction && self.status() & flag != 0
    }

    /// When the running frame ends.
    pub fn next_event(&self) -> Ticks {
        self.shifting.map_or(NEVER, |(_, at)| at)
    }

    /// Ends the running frame if its time has come, and begins the next.
    pub fn advance(&mut self, clocks: &Clocks) {
        let Some((command, at)) = self.shifting.filter(|&(_, at)| at <= clocks.now) else {
            return;
        };
        self.shifting = None;
        let mask = (1u32 << self.frame_size(command)) - 1;
        let data = command & mask;
        self.sent.push(data as u16);
        self.tcr = self.tcr.wrapping_add(0x1_0000);
        self.flags |= TCF | if command & 1 << 27 != 0 { EOQF } else { 0 };
        let answer = if self.wire == Wire::Loopback {
            data
        } else {
            mask
        };
        if self.receive.len() < DEPTH {
            self.receive.push_back(answer);
        } else {
            self.flags |= RFOF;
        }
        self.begin(at, clocks);
    }

    fn attributes_of(&self, command: u32) -> u32 {
        self.attributes[(command >> 28 & 1) as usize]
    }

    fn frame_size(&self, command: u32) -> u32 {
        (self.attributes_of(command) >> 27 & 0xF) + 1
    }

    /// Starts the next frame. EOQF stops transmission until it is cleared.
    fn begin(&mut self, now: Ticks, clocks: &Clocks) {
        let runs = self.mcr & (MSTR | MDIS | HALT) == MSTR && self.flags & EOQF == 0;
        if !runs || self.shifting.is_some() {
            return;
        }
        if let Some(command) = self.transmit.pop_front() {
            let attributes = self.attributes_of(command);
            let field = |shift: u32| (attributes >> shift & 0xF) as usize;
            let bit = PBR[field(16) & 3] * BR[field(0)] / (1 + u64::from(attributes >> 31));
            // Delays before the first and after the last edge: prescaler times 2^(scaler + 1).
            let delay = |prescaler: u32, scaler: u32| {
                [1, 3, 5, 7][field(prescaler) & 3] << (field(scaler) + 1)
            };
            let cycles = u64::from(self.frame_size(command)) * bit + delay(22, 12) + delay(20, 8);
            self.shifting = Some((command, now + time::of_cycles(cycles, clocks.bus_hz)));
        }
    }

    /// Reads a register.
    pub fn read(&mut self, offset: u32) -> u32 {
        match offset {
            MCR => self.mcr,
            TCR => self.tcr,
            CTAR0 => self.attributes[0],
            CTAR1 => self.attributes[1],
            SR => self.status(),
            RSER => self.rser,
            PUSHR => self.transmit.back().copied().unwrap_or(0),
            POPR => self.receive.pop_front().unwrap_or(0),
            TXFR0..=0x48 => self
                .transmit
                .get((offset - TXFR0) as usize / 4)
                .copied()
                .unwrap_or(0),
            RXFR0..=0x88 => self
                .receive
                .get((offset - RXFR0) as usize / 4)
                .copied()
                .unwrap_or(0),
            _ => 0,
        }
    }

    /// Writes a register; a narrow write to PUSHR leaves the command half at 0.
    pub fn write(&mut self, offset: u32, value: u32, clocks: &Clocks) {
        match offset {
            MCR => {
                // CLR_TXF and CLR_RXF.
                if value & 1 << 11 != 0 {
                    self.transmit.clear();
                }
                if value & 1 << 10 != 0 {
                    self.receive.clear();
                }
                self.mcr = value & !(3 << 10);
                self.begin(clocks.now, clocks);
            }
            TCR => self.tcr = value & 0xFFFF_0000,
            CTAR0 => self.attributes[0] = value,
            CTAR1 => self.attributes[1] = value,
            SR => {
                self.flags &= !value;
                self.begin(clocks.now, clocks);
            }
            RSER => self.rser = value,
            PUSHR => {
                if self.transmit.len() < DEPTH {
                    self.transmit.push_back(value);
                }
                self.begin(clocks.now, clocks);
            }
            _ => {}
        }
    }
}

impl Default for Spi {
    fn default() -> Spi {
        Spi::new()
    }
}
