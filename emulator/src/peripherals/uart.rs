//! Asynchronous serial interface (K20 manual, chapter "Universal Asynchronous Receiver/Transmitter (UART)"): characters
//! take their bit times, in both directions and through the FIFOs.

use std::collections::VecDeque;

use crate::time::{NEVER, SECOND, Ticks};

const BDH: usize = 0x0;
const BDL: usize = 0x1;
const C1: usize = 0x2;
const C2: usize = 0x3;
const S1: usize = 0x4;
const S2: usize = 0x5;
const C3: usize = 0x6;
const D: usize = 0x7;
const C4: usize = 0xA;
const C5: usize = 0xB;
const PFIFO: usize = 0x10;
const CFIFO: usize = 0x11;
const SFIFO: usize = 0x12;
const TWFIFO: usize = 0x13;
const TCFIFO: usize = 0x14;
const RWFIFO: usize = 0x15;
const RCFIFO: usize = 0x16;

const LOOPS: u8 = 1 << 7;
const RSRC: u8 = 1 << 5;
const TE: u8 = 1 << 3;
const RE: u8 = 1 << 2;

const TDRE: u8 = 1 << 7;
const TC: u8 = 1 << 6;
const RDRF: u8 = 1 << 5;
const IDLE: u8 = 1 << 4;
const OR: u8 = 1 << 3;

const TXFE: u8 = 1 << 7;
const RXFE: u8 = 1 << 3;
const RXUF: u8 = 1 << 0;
const TXOF: u8 = 1 << 1;

/// A character of up to nine bits.
type Character = u16;

/// One interface.
#[derive(Debug, Clone)]
pub struct Uart {
    registers: [u8; 0x20],
    /// FIFO depth of this instance where it is enabled: 8 or 1.
    depth: usize,
    transmit: VecDeque<Character>,
    shifting: Option<(Character, Ticks)>,
    receive: VecDeque<Character>,
    /// Characters on their way in, and when the next is complete.
    arriving: VecDeque<Character>,
    arrives: Ticks,
    /// When the line will have been idle for a character.
    idle_at: Ticks,
    /// Flags that reading S1 and then D clears, and those that S1 has shown.
    sticky: u8,
    shown: u8,
    /// Bytes sent with the pin connected, until somebody takes them.
    pub sent: Vec<u8>,
}

impl Uart {
    /// The state after reset of an instance with FIFOs of `depth` characters.
    pub fn new(depth: usize) -> Uart {
        let mut registers = [0; 0x20];
        registers[BDL] = 0x04;
        // TXFIFOSIZE and RXFIFOSIZE: 0 is one character, 2 is eight.
        registers[PFIFO] = if depth == 8 { 0x22 } else { 0x00 };
        registers[SFIFO] = 0xC0;
        registers[RWFIFO] = 1;
        Uart {
            registers,
            depth,
            transmit: VecDeque::new(),
            shifting: None,
            receive: VecDeque::new(),
            arriving: VecDeque::new(),
            arrives: NEVER,
            idle_at: NEVER,
            sticky: 0,
            shown: 0,
            sent: Vec::new(),
        }
    }

    /// A system reset; what was sent before stays to be taken.
    pub fn reset(&mut self) {
        let sent = std::mem::take(&mut self.sent);
        *self = Uart {
            sent,
            ..Uart::new(self.depth)
        };
    }

    /// Puts bytes on the receive line, one after the other at the receiver's own rate.
    pub fn receive(&mut self, bytes: &[u8], now: Ticks, clock_hz: u32) {
        if self.arriving.is_empty() && !bytes.is_empty() {
            self.arrives = now + self.character_time(clock_hz);
        }
        self.arriving
            .extend(bytes.iter().map(|&byte| Character::from(byte)));
    }

    /// Bits in a character with start and stop bit.
    fn bits(&self) -> u64 {
        10 + u64::from(self.registers[C1] >> 4 & 1) + u64::from(self.registers[BDH] >> 5 & 1)
    }

    fn character_time(&self, clock_hz: u32) -> Ticks {
        let sbr = u64::from(self.registers[BDH] & 0x1F) << 8 | u64::from(self.registers[BDL]);
        // The divisor in 32nds; sixteen samples make a bit.
        let divisor = (sbr * 32 + u64::from(self.registers[C4] & 0x1F)).max(32);
        let cycles = u128::from(self.bits() * 16 * divisor);
        (cycles * u128::from(SECOND)).div_ceil(32 * u128::from(clock_hz.max(1))) as Ticks
    }

    fn depth_of(&self, enable: u8) -> usize {
        if self.registers[PFIFO] & enable != 0 {
            self.depth
        } else {
            1
        }
    }

    fn status(&self) -> u8 {
        let watermark = |n: usize| usize::from(self.registers[n]);
        let empty = self.transmit.len()
            <= if self.registers[PFIFO] & TXFE != 0 {
                watermark(TWFIFO)
            } else {
                0
            };
        let full = self.receive.len()
            >= if self.registers[PFIFO] & RXFE != 0 {
                watermark(RWFIFO).max(1)
            } else {
                1
            };
        let complete = self.transmit.is_empty() && self.shifting.is_none();
        self.sticky
            | if empty { TDRE } else { 0 }
            | if complete { TC } else { 0 }
            | if full { RDRF } else { 0 }
    }

    /// Whether transmitter, receiver or idle line ask for the status interrupt.
    pub fn status_interrupt(&self) -> bool {
        // TIE, TCIE, RIE and ILIE stand where TDRE, TC, RDRF and IDLE do; a flag may go to DMA instead.
        let direct = !(self.registers[C5] & (1 << 7 | 1 << 5));
        self.status() & self.registers[C2] & direct & (TDRE | TC | RDRF | IDLE) != 0
    }

    /// Whether an overrun asks for the error interrupt.
    pub fn error_interrupt(&self) -> bool {
        self.status() & OR != 0 && self.registers[C3] & 1 << 3 != 0
    }

    /// Whether the transmitter (`true`) or the receiver asks for DMA.
    pub fn dma_request(&self, transmitter: bool) -> bool {
        let (flag, bit) = if transmitter {
            (TDRE, 1 << 7)
        } else {
            (RDRF, 1 << 5)
        };
        self.registers[C5] & bit != 0 && self.registers[C2] & self.status() & flag != 0
    }

    /// When a character is complete next.
    pub fn next_event(&self) -> Ticks {
        let sent = self.shifting.map_or(NEVER, |(_, at)| at);
        sent.min(self.arrives).min(self.idle_at)
    }

    /// Completes the characters whose time has come. `connected` tells whether the transmit pin is this interface's.
    pub fn advance(&mut self, now: Ticks, clock_hz: u32, connected: bool) {
        if let Some((character, at)) = self.shifting.filter(|&(_, at)| at <= now) {
            self.shifting = None;
            if self.registers[C1] & (LOOPS | RSRC) == LOOPS {
                self.take_in(character, at, clock_hz);
            } else if connected {
                self.sent.push(character as u8);
            }
            self.shift(at, clock_hz);
        }
        while self.arrives <= now {
            let at = self.arrives;
            if let Some(character) = self.arriving.pop_front() {
                self.take_in(character, at, clock_hz);
            }
            self.arrives = if self.arriving.is_empty() {
                NEVER
            } else {
                at + self.character_time(clock_hz)
            };
        }
        if self.idle_at <= now {
            self.idle_at = NEVER;
            self.sticky |= IDLE;
        }
    }

    fn take_in(&mut self, character: Character, at: Ticks, clock_hz: u32) {
        if self.registers[C2] & RE == 0 {
            return;
        }
        self.idle_at = at + self.character_time(clock_hz);
        if self.receive.len() >= self.depth_of(RXFE) {
            self.sticky |= OR;
        } else {
            self.receive.push_back(character);
        }
    }

    fn shift(&mut self, now: Ticks, clock_hz: u32) {
        if self.registers[C2] & TE != 0
            && self.shifting.is_none()
            && let Some(character) = self.transmit.pop_front()
        {
            self.shifting = Some((character, now + self.character_time(clock_hz)));
        }
    }

    /// Reads an 8-bit register. Reading D takes a character and clears the flags that S1 has shown.
    pub fn read(&mut self, offset: u32) -> u32 {
        let register = offset as usize;
        u32::from(match register {
            S1 => {
                let status = self.status();
                self.shown = status;
                status
            }
            D => {
                self.sticky &= !(self.shown & (IDLE | OR));
                self.shown = 0;
                match self.receive.pop_front() {
                    Some(character) => {
                        self.registers[C3] =
                            self.registers[C3] & 0x7F | (character >> 8 << 7) as u8;
                        character as u8
                    }
                    None => {
                        // The FIFO's pointers are out of step until it is flushed; only the flag is modelled.
                        self.registers[SFIFO] |= RXUF;
                        0
                    }
                }
            }
            SFIFO => {
                self.registers[SFIFO] & 0x07
                    | if self.transmit.is_empty() { 0x80 } else { 0 }
                    | if self.receive.is_empty() { 0x40 } else { 0 }
            }
            TCFIFO => self.transmit.len() as u8,
            RCFIFO => self.receive.len() as u8,
            register => self.registers.get(register).copied().unwrap_or(0),
        })
    }

    /// Writes an 8-bit register.
    pub fn write(&mut self, offset: u32, value: u8, now: Ticks, clock_hz: u32) {
        match offset as usize {
            D => {
                if self.transmit.len() < self.depth_of(TXFE) {
                    let ninth =
                        Character::from(self.registers[C3] >> 6 & 1 & self.registers[C1] >> 4) << 8;
                    self.transmit.push_back(Character::from(value) | ninth);
                } else {
                    self.registers[SFIFO] |= TXOF;
                }
                self.shift(now, clock_hz);
            }
            C2 => {
                self.registers[C2] = value;
                self.shift(now, clock_hz);
            }
            C3 => self.registers[C3] = self.registers[C3] & 0x80 | value & 0x7F,
            PFIFO => self.registers[PFIFO] = self.registers[PFIFO] & 0x77 | value & (TXFE | RXFE),
            CFIFO => {
                if value & 0x80 != 0 {
                    self.transmit.clear();
                }
                if value & 0x40 != 0 {
                    self.receive.clear();
                }
                self.registers[CFIFO] = value & 0x07;
            }
            SFIFO => self.registers[SFIFO] &= !(value & 0x07),
            S2 => self.registers[S2] = value & 0x3F,
            S1 | TCFIFO | RCFIFO => {}
            register => {
                if let Some(place) = self.registers.get_mut(register) {
                    *place = value;
                }
            }
        }
    }
}
