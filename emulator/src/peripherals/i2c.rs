//! Inter-integrated circuit module as a master (K20 manual, chapter 46): every byte takes its nine bit times, and the
//! flags rise only then.

use super::pins::Pins;
use crate::time::{self, NEVER, Ticks};

const F: u32 = 1;
const C1: u32 = 2;
const S: u32 = 3;
const D: u32 = 4;

const IICEN: u8 = 1 << 7;
const IICIE: u8 = 1 << 6;
const MST: u8 = 1 << 5;
const TX: u8 = 1 << 4;
const TXAK: u8 = 1 << 3;
const RSTA: u8 = 1 << 2;

const TCF: u8 = 1 << 7;
const BUSY: u8 = 1 << 5;
const ARBL: u8 = 1 << 4;
const IICIF: u8 = 1 << 1;
const RXAK: u8 = 1 << 0;

/// SCL divider by ICR (table 46-41).
const SCL_DIVIDER: [u16; 64] = [
    20, 22, 24, 26, 28, 30, 34, 40, 28, 32, 36, 40, 44, 48, 56, 68, 48, 56, 64, 72, 80, 88, 104,
    128, 80, 96, 112, 128, 144, 160, 192, 240, 160, 192, 224, 256, 288, 320, 384, 480, 320, 384,
    448, 512, 576, 640, 768, 960, 640, 768, 896, 1024, 1152, 1280, 1536, 1920, 1280, 1536, 1792,
    2048, 2304, 2560, 3072, 3840,
];

/// A device on the bus, as its own pins see a transfer.
pub trait Target {
    /// An address byte after a START; `true` acknowledges.
    fn address(&mut self, byte: u8, now: Ticks) -> bool;
    /// A byte written to it; `true` acknowledges.
    fn write(&mut self, byte: u8, now: Ticks) -> bool;
    /// A byte read from it.
    fn read(&mut self, now: Ticks) -> u8;
    /// A STOP.
    fn stop(&mut self);
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Transfer {
    Address(u8),
    Write(u8),
    Read,
    /// A STOP condition on its way; it is not software's to wait for.
    Stop,
}

/// The module.
#[derive(Debug, Clone, Default)]
pub struct I2c {
    registers: [u8; 12],
    status: u8,
    data: u8,
    /// A START or repeated START was sent, so the next byte is an address.
    addressing: bool,
    running: Option<(Transfer, Ticks)>,
}

impl I2c {
    /// The state after reset.
    pub fn new() -> I2c {
        I2c {
            status: TCF,
            ..I2c::default()
        }
    }

    /// When the running transfer ends.
    pub fn next_event(&self) -> Ticks {
        self.running.map_or(NEVER, |(_, at)| at)
    }

    /// Whether the module asks for its interrupt.
    pub fn interrupt(&self) -> bool {
        self.registers[C1 as usize] & IICIE != 0 && self.status & IICIF != 0
    }

    fn control(&self) -> u8 {
        self.registers[C1 as usize]
    }

    fn bits(&self, n: u64, bus_hz: u32) -> Ticks {
        let frequency = self.registers[F as usize];
        let multiplier = 1u64 << (frequency >> 6).min(2);
        let divider = u64::from(SCL_DIVIDER[usize::from(frequency & 0x3F)]);
        time::of_cycles(n * multiplier * divider, bus_hz)
    }

    /// Ends the running transfer if its time has come.
    pub fn advance(&mut self, now: Ticks, pins: &Pins, target: &mut dyn Target) {
        let Some((transfer, at)) = self.running else {
            return;
        };
        if now < at {
            return;
        }
        if !pins.scl() {
            // Somebody holds the clock: the transfer does not end.
            self.running = Some((transfer, NEVER));
            return;
        }
        self.running = None;
        let connected = pins.i2c_connected() && pins.sda();
        let acknowledged = match transfer {
            Transfer::Stop => {
                self.status &= !BUSY;
                if connected {
                    target.stop();
                }
                return;
            }
            Transfer::Address(byte) => connected && target.address(byte, now),
            Transfer::Write(byte) => connected && target.write(byte, now),
            Transfer::Read => {
                self.data = if connected { target.read(now) } else { 0xFF };
                self.control() & TXAK == 0
            }
        };
        self.status = self.status & !RXAK | TCF | IICIF | u8::from(!acknowledged);
    }

    /// Reads an 8-bit register. Reading D while receiving starts the next byte.
    pub fn read(&mut self, offset: u32, now: Ticks, bus_hz: u32) -> u32 {
        match offset {
            S => u32::from(self.status),
            C1 => u32::from(self.control() & !RSTA),
            D => {
                let value = self.data;
                let receiving = self.control() & (IICEN | MST | TX) == IICEN | MST;
                if receiving && self.running.is_none() {
                    self.begin(Transfer::Read, now + self.bits(9, bus_hz));
                }
                u32::from(value)
            }
            _ => u32::from(self.registers.get(offset as usize).copied().unwrap_or(0)),
        }
    }

    fn begin(&mut self, transfer: Transfer, until: Ticks) {
        self.status &= !TCF;
        self.running = Some((transfer, until));
    }

    /// Writes an 8-bit register.
    pub fn write(&mut self, offset: u32, value: u8, now: Ticks, bus_hz: u32, pins: &Pins) {
        match offset {
            C1 => self.write_control(value, now, bus_hz, pins),
            S => self.status &= !(value & (IICIF | ARBL)),
            D => {
                let sending = self.control() & (IICEN | MST | TX) == IICEN | MST | TX;
                if sending
                    && self
                        .running
                        .is_none_or(|(transfer, _)| transfer == Transfer::Stop)
                {
                    let transfer = if self.addressing {
                        Transfer::Address(value)
                    } else {
                        Transfer::Write(value)
                    };
                    // A START takes about one more bit time before the first clock.
                    let bits = if self.addressing { 10 } else { 9 };
                    self.addressing = false;
                    self.begin(transfer, now + self.bits(bits, bus_hz));
                }
            }
            _ => {
                if let Some(register) = self.registers.get_mut(offset as usize) {
                    *register = value;
                }
            }
        }
    }

    fn write_control(&mut self, value: u8, now: Ticks, bus_hz: u32, pins: &Pins) {
        let before = self.control();
        self.registers[C1 as usize] = value & !RSTA;
        if value & IICEN == 0 {
            // A disabled module lets go of the bus and forgets what it was doing.
            self.running = None;
            self.addressing = false;
            self.status = self.status & IICIF | TCF;
            return;
        }
        let (was_master, is_master) = (before & MST != 0, value & MST != 0);
        if is_master && !was_master {
            if pins.sda() && pins.scl() {
                self.addressing = true;
                self.status |= BUSY;
            } else {
                // The bus is held by somebody else: arbitration is lost at once (46.4.1.6).
                self.status |= ARBL | IICIF;
                self.registers[C1 as usize] &= !MST;
            }
        } else if was_master && !is_master {
            self.running = Some((Transfer::Stop, now + self.bits(1, bus_hz)));
            self.addressing = false;
        } else if is_master && value & RSTA != 0 {
            self.addressing = true;
        }
    }
}
