//! Direct memory access controller (K20 manual, chapter 21, "Direct Memory Access Controller (eDMA)"): sixteen transfer
//! control descriptors, minor and major loops, linking, scatter/gather.

use std::ops::Range;

const CR: u32 = 0x00;
const ES: u32 = 0x04;
const ERQ: u32 = 0x0C;
const EEI: u32 = 0x14;
/// Registers that set or clear a channel's bit elsewhere: CEEI, SEEI, CERQ, SERQ, CDNE, SSRT, CERR, CINT.
const BY_NUMBER: Range<u32> = 0x18..0x20;
const INT: u32 = 0x24;
const ERR: u32 = 0x2C;
const HRS: u32 = 0x34;
const PRIORITIES: u32 = 0x100;
/// The descriptors' place, counted from the controller's base.
const DESCRIPTORS: u32 = 0x1000;

const EMLM: u32 = 1 << 7;

/// Bytes of a descriptor, and where its fields stand in it.
const SIZE: usize = 32;
const SADDR: usize = 0x00;
const SOFF: usize = 0x04;
const ATTR: usize = 0x06;
const NBYTES: usize = 0x08;
const SLAST: usize = 0x0C;
const DADDR: usize = 0x10;
const DOFF: usize = 0x14;
const CITER: usize = 0x16;
const DLAST: usize = 0x18;
const CSR: usize = 0x1C;
const BITER: usize = 0x1E;

/// CSR (21.3, TCD Control and Status).
const DONE: u16 = 1 << 7;
const MAJORELINK: u16 = 1 << 5;
const ESG: u16 = 1 << 4;
const DREQ: u16 = 1 << 3;
const INTHALF: u16 = 1 << 2;
const INTMAJOR: u16 = 1 << 1;
const START: u16 = 1 << 0;
/// CITER and BITER: link after each minor loop.
const ELINK: u16 = 1 << 15;

/// Bytes that one minor loop may move here: more than all memory, so that none runs for minutes.
const LONGEST: u32 = 1 << 20;

/// Error status: source address, offset, destination address, offset, counts, scatter/gather, source bus, destination
/// bus; and "some error".
const SAE: u32 = 1 << 7;
const DAE: u32 = 1 << 5;
const NCE: u32 = 1 << 3;
const SGE: u32 = 1 << 2;
const SBE: u32 = 1 << 1;
const DBE: u32 = 1 << 0;
const VLD: u32 = 1 << 31;

/// What the controller reads and writes.
pub trait Bus {
    /// Reads `width` bytes; `None` is a bus error.
    fn read(&mut self, address: u32, width: u8) -> Option<u32>;
    /// Writes `width` bytes; `false` is a bus error.
    fn write(&mut self, address: u32, width: u8, value: u32) -> bool;
}

/// The controller.
#[derive(Debug, Clone)]
pub struct Dma {
    control: u32,
    error_status: u32,
    requests_enabled: u32,
    errors_enabled: u32,
    interrupts: u32,
    errors: u32,
    priorities: [u8; 16],
    descriptors: [[u8; SIZE]; 16],
}

impl Dma {
    /// The state after reset. Descriptors are undefined then; here they are zero.
    pub fn new() -> Dma {
        Dma {
            control: 0,
            error_status: 0,
            requests_enabled: 0,
            errors_enabled: 0,
            interrupts: 0,
            errors: 0,
            // DCHPRI3 stands first in its word.
            priorities: std::array::from_fn(|at| at as u8 ^ 3),
            descriptors: [[0; SIZE]; 16],
        }
    }

    /// Channels that ask for their interrupt, one bit each.
    pub fn interrupts(&self) -> u32 {
        self.interrupts
    }

    /// Whether a failed transfer asks for the error interrupt.
    pub fn error_interrupt(&self) -> bool {
        self.errors & self.errors_enabled != 0
    }

    /// Channels that listen to their hardware request, one bit each.
    pub fn listening(&self) -> u32 {
        self.requests_enabled
    }

    fn half(&self, channel: usize, at: usize) -> u16 {
        u16::from_le_bytes([
            self.descriptors[channel][at],
            self.descriptors[channel][at + 1],
        ])
    }

    fn word(&self, channel: usize, at: usize) -> u32 {
        u32::from(self.half(channel, at)) | u32::from(self.half(channel, at + 2)) << 16
    }

    fn set_half(&mut self, channel: usize, at: usize, value: u16) {
        self.descriptors[channel][at..at + 2].copy_from_slice(&value.to_le_bytes());
    }

    fn set_word(&mut self, channel: usize, at: usize, value: u32) {
        self.descriptors[channel][at..at + 4].copy_from_slice(&value.to_le_bytes());
    }

    /// The channel that is served next, if `requested` by hardware (one bit each) or by software.
    pub fn next_channel(&self, requested: u32) -> Option<usize> {
        (0..16)
            .filter(|&channel| {
                let software = self.half(channel, CSR) & START != 0;
                software || self.requests_enabled & requested & 1 << channel != 0
            })
            .max_by_key(|&channel| self.priorities[channel ^ 3] & 0xF)
    }

    /// Runs one minor loop of `channel`; returns how many accesses it made.
    pub fn serve(&mut self, channel: usize, bus: &mut dyn Bus) -> u32 {
        let csr = self.half(channel, CSR) & !(START | DONE);
        self.set_half(channel, CSR, csr);
        match self.minor_loop(channel, bus) {
            Ok(accesses) => {
                if let Err(error) = self.count(channel, bus) {
                    self.fail(channel, error);
                }
                accesses
            }
            Err(error) => {
                self.fail(channel, error);
                1
            }
        }
    }

    fn fail(&mut self, channel: usize, error: u32) {
        self.error_status = VLD | (channel as u32) << 8 | error;
        self.errors |= 1 << channel;
        self.requests_enabled &= !(1 << channel);
    }

    fn minor_loop(&mut self, channel: usize, bus: &mut dyn Bus) -> Result<u32, u32> {
        let attributes = self.half(channel, ATTR);
        let width = |code: u16| 1u32 << (code & 7).min(5);
        let (source_size, target_size) = (width(attributes >> 8), width(attributes));
        let bytes = self.word(channel, NBYTES);
        let (bytes, offset) = match (self.control & EMLM != 0, bytes >> 30) {
            (false, _) => (bytes, 0),
            (true, 0) => (bytes & 0x3FFF_FFFF, 0),
            // A signed 20-bit offset.
            (true, _) => (bytes & 0x3FF, ((bytes << 2) as i32 >> 12) as u32),
        };
        let (mut source, mut target) = (self.word(channel, SADDR), self.word(channel, DADDR));
        let step = source_size.max(target_size);
        if !source.is_multiple_of(source_size.min(4)) {
            return Err(SAE);
        }
        if !target.is_multiple_of(target_size.min(4)) {
            return Err(DAE);
        }
        let count = self.half(channel, CITER);
        let left = count & count_mask(count);
        let links_differ = (count ^ self.half(channel, BITER)) & ELINK != 0;
        if bytes == 0 || bytes > LONGEST || !bytes.is_multiple_of(step) || left == 0 || links_differ
        {
            return Err(NCE);
        }
        let source_offset = i32::from(self.half(channel, SOFF) as i16) as u32;
        let target_offset = i32::from(self.half(channel, DOFF) as i16) as u32;
        let (source_modulo, target_modulo) = (attributes >> 11 & 0x1F, attributes >> 3 & 0x1F);
        let mut accesses = 0;
        for _ in 0..bytes / step {
            let mut data = Vec::with_capacity(32);
            for _ in 0..step / source_size {
                for part in (0..source_size).step_by(4) {
                    let width = source_size.min(4) as u8;
                    let value = bus.read(source.wrapping_add(part), width).ok_or(SBE)?;
                    data.extend_from_slice(&value.to_le_bytes()[..usize::from(width)]);
                    accesses += 1;
                }
                source = advanced(source, source_offset, source_modulo);
            }
            for chunk in data.chunks(target_size as usize) {
                for (part, bytes) in (0..).step_by(4).zip(chunk.chunks(4)) {
                    let value = bytes
                        .iter()
                        .rev()
                        .fold(0, |word, &byte| word << 8 | u32::from(byte));
                    if !bus.write(target.wrapping_add(part), bytes.len() as u8, value) {
                        return Err(DBE);
                    }
                    accesses += 1;
                }
                target = advanced(target, target_offset, target_modulo);
            }
        }
        if self.control & EMLM != 0 {
            let nbytes = self.word(channel, NBYTES);
            source = if nbytes >> 31 != 0 {
                source.wrapping_add(offset)
            } else {
                source
            };
            target = if nbytes >> 30 & 1 != 0 {
                target.wrapping_add(offset)
            } else {
                target
            };
        }
        self.set_word(channel, SADDR, source);
        self.set_word(channel, DADDR, target);
        Ok(accesses)
    }

    /// Counts the minor loop that has ended, and ends the major loop with the last one.
    fn count(&mut self, channel: usize, bus: &mut dyn Bus) -> Result<(), u32> {
        let (citer, biter) = (self.half(channel, CITER), self.half(channel, BITER));
        let linked = citer & ELINK != 0;
        let mask = count_mask(citer);
        let left = (citer & mask) - 1;
        let csr = self.half(channel, CSR);
        if left > 0 {
            self.set_half(channel, CITER, citer & !mask | left);
            if csr & INTHALF != 0 && left == (biter & mask) / 2 {
                self.interrupts |= 1 << channel;
            }
            if linked {
                self.start(usize::from(citer >> 9 & 0xF));
            }
            return Ok(());
        }
        let source = self
            .word(channel, SADDR)
            .wrapping_add(self.word(channel, SLAST));
        self.set_word(channel, SADDR, source);
        self.set_half(channel, CITER, biter);
        self.set_half(channel, CSR, csr | DONE);
        if csr & INTMAJOR != 0 {
            self.interrupts |= 1 << channel;
        }
        if csr & DREQ != 0 {
            self.requests_enabled &= !(1 << channel);
        }
        if csr & MAJORELINK != 0 {
            self.start(usize::from(csr >> 8 & 0xF));
        }
        let last = self.word(channel, DLAST);
        if csr & ESG != 0 {
            self.load(channel, last, bus)
        } else {
            let target = self.word(channel, DADDR).wrapping_add(last);
            self.set_word(channel, DADDR, target);
            Ok(())
        }
    }

    fn start(&mut self, channel: usize) {
        let csr = self.half(channel, CSR) | START;
        self.set_half(channel, CSR, csr);
    }

    /// Scatter/gather: the next descriptor comes from memory.
    fn load(&mut self, channel: usize, from: u32, bus: &mut dyn Bus) -> Result<(), u32> {
        if !from.is_multiple_of(32) {
            return Err(SGE);
        }
        for at in (0..SIZE).step_by(4) {
            let word = bus.read(from.wrapping_add(at as u32), 4).ok_or(SBE)?;
            self.set_word(channel, at, word);
        }
        Ok(())
    }

    /// Reads `width` bytes; the descriptors follow from offset 0x1000 on.
    pub fn read(&self, offset: u32, width: u8) -> u32 {
        (0..u32::from(width))
            .map(|i| u32::from(self.byte(offset + i)) << (8 * i))
            .sum()
    }

    fn byte(&self, offset: u32) -> u8 {
        if let Some(at) = offset.checked_sub(DESCRIPTORS) {
            return self
                .descriptors
                .as_flattened()
                .get(at as usize)
                .copied()
                .unwrap_or(0);
        }
        let register = match offset & !3 {
            CR => self.control,
            ES => self.error_status,
            ERQ => self.requests_enabled,
            EEI => self.errors_enabled,
            INT => self.interrupts,
            ERR => self.errors,
            HRS => 0,
            PRIORITIES..0x110 => return self.priorities[(offset - PRIORITIES) as usize],
            _ => 0,
        };
        (register >> (8 * (offset & 3))) as u8
    }

    /// Writes `width` bytes.
    pub fn write(&mut self, offset: u32, width: u8, value: u32) {
        let bytes = value.to_le_bytes();
        if let Some(at) = offset.checked_sub(DESCRIPTORS) {
            let at = at as usize;
            if let Some(place) = self
                .descriptors
                .as_flattened_mut()
                .get_mut(at..at + usize::from(width))
            {
                place.copy_from_slice(&bytes[..usize::from(width)]);
            }
            return;
        }
        match offset {
            CR => self.control = value & 0x3_00FE,
            ERQ => self.requests_enabled = value & 0xFFFF,
            EEI => self.errors_enabled = value & 0xFFFF,
            INT => self.interrupts &= !value,
            ERR => self.errors &= !value,
            _ if BY_NUMBER.contains(&offset) => {
                for (register, byte) in (offset..BY_NUMBER.end).zip(&bytes[..usize::from(width)]) {
                    self.by_number(register, *byte);
                }
            }
            PRIORITIES..0x110 => {
                for (at, byte) in
                    ((offset - PRIORITIES) as usize..16).zip(&bytes[..usize::from(width)])
                {
                    self.priorities[at] = *byte;
                }
            }
            _ => {}
        }
    }

    /// Bit 7 is "no operation", bit 6 means all channels.
    fn by_number(&mut self, register: u32, value: u8) {
        if value & 0x80 != 0 {
            return;
        }
        let channels: u32 = if value & 0x40 != 0 {
            0xFFFF
        } else {
            1 << (value & 0xF)
        };
        match register - BY_NUMBER.start {
            0 => self.errors_enabled &= !channels,
            1 => self.errors_enabled |= channels,
            2 => self.requests_enabled &= !channels,
            3 => self.requests_enabled |= channels,
            4 | 5 => {
                for channel in (0..16).filter(|channel| channels >> channel & 1 != 0) {
                    let csr = self.half(channel, CSR);
                    self.set_half(
                        channel,
                        CSR,
                        if register & 1 == 0 {
                            csr & !DONE
                        } else {
                            csr | START
                        },
                    );
                }
            }
            6 => self.errors &= !channels,
            _ => self.interrupts &= !channels,
        }
    }
}

/// The count in CITER or BITER: nine bits where the rest names a channel to link to.
fn count_mask(register: u16) -> u16 {
    if register & ELINK != 0 { 0x1FF } else { 0x7FFF }
}

/// An address after an access, within its modulo if it has one.
fn advanced(address: u32, offset: u32, modulo: u16) -> u32 {
    let next = address.wrapping_add(offset);
    let mask = match modulo {
        0 => return next,
        bits => (1u32 << bits) - 1,
    };
    address & !mask | next & mask
}

impl Default for Dma {
    fn default() -> Dma {
        Dma::new()
    }
}
