//! Inter-integrated circuit module as a master (K20 manual, chapter 46): every byte takes its nine bit times, and the
//! flags rise only then. With DMAEN the end of a byte asks for a transfer instead of an interrupt (section "DMA support").

use super::pins::{Pins, Wiring};
use crate::journal::{Happening, I2cByte, Journal};
use crate::time::{self, NEVER, Ticks};
use crate::witness::{Trap, Witness};

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
const DMAEN: u8 = 1 << 0;

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
    /// The last byte read was acknowledged, so the target goes on sending.
    more_promised: bool,
    /// Time taken by transfers.
    busy: Ticks,
}

/// The module counts SCL's high time from when it sees the line high, so the line's rise lengthens every period. The
/// I2C-bus specification allows 300 ns; Teensyduino's Wire takes the divider for 428 kHz to make 400 kHz.
const RISE: Ticks = 170 * time::MICROSECOND / 1000;
/// The fastest that the MPU-9250's registers can be accessed.
const FASTEST_HZ: u64 = 400_000;

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

    /// Whether the module asks for its interrupt. With DMAEN only lost arbitration does.
    pub fn interrupt(&self) -> bool {
        let asks = if self.control() & DMAEN != 0 {
            ARBL
        } else {
            IICIF
        };
        self.control() & IICIE != 0 && self.status & asks != 0
    }

    /// Whether the module asks for a transfer: a byte is complete, and nobody has fetched or replaced it.
    pub fn dma_request(&self) -> bool {
        const WANTED: u8 = IICEN | IICIE | DMAEN;
        self.control() & WANTED == WANTED && self.status & TCF != 0
    }

    /// Time in which the bus was not free, since the reset (ticks).
    pub fn busy_time(&self) -> Ticks {
        self.busy
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
    pub fn advance(
        &mut self,
        (now, bus_hz): (Ticks, u32),
        pins: &Pins,
        target: &mut dyn Target,
        journal: &mut Journal,
        witness: &mut Witness,
    ) {
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
                journal.note(at, || Happening::I2cStop {
                    bit: self.bits(1, bus_hz),
                });
                if connected {
                    target.stop();
                }
                return;
            }
            Transfer::Address(byte) => connected && target.address(byte, now),
            Transfer::Write(byte) => connected && target.write(byte, now),
            Transfer::Read => {
                self.data = if connected { target.read(now) } else { 0xFF };
                self.more_promised = self.control() & TXAK == 0;
                if !self.more_promised && self.control() & DMAEN != 0 {
                    witness.saw(
                        Trap::I2cDmaLastByte,
                        "the byte that TXAK leaves unacknowledged ended with DMAEN set",
                    );
                }
                self.more_promised
            }
        };
        self.status = self.status & !RXAK | TCF | IICIF | u8::from(!acknowledged);
        let (kind, byte) = match transfer {
            Transfer::Address(byte) => (I2cByte::Address, byte),
            Transfer::Write(byte) => (I2cByte::Written, byte),
            _ => (I2cByte::Read, self.data),
        };
        journal.note(at, || Happening::I2cByte {
            kind,
            byte,
            acknowledged,
            bit: self.bits(1, bus_hz),
        });
    }

    /// Reads an 8-bit register. Reading D while receiving starts the next byte.
    pub fn read(&mut self, offset: u32, now: Ticks, bus_hz: u32, witness: &mut Witness) -> u32 {
        match offset {
            S => u32::from(self.status),
            C1 => u32::from(self.control() & !RSTA),
            D => {
                let value = self.data;
                let receiving = self.control() & (IICEN | MST | TX) == IICEN | MST;
                match self.running {
                    Some((Transfer::Read, _)) => witness.saw(
                        Trap::I2cDataEarly,
                        "D was read while its byte was still on its way",
                    ),
                    None if receiving => self.begin(Transfer::Read, now, self.bits(9, bus_hz)),
                    _ => {}
                }
                u32::from(value)
            }
            _ => u32::from(self.registers.get(offset as usize).copied().unwrap_or(0)),
        }
    }

    fn begin(&mut self, transfer: Transfer, now: Ticks, length: Ticks) {
        self.status &= !TCF;
        self.more_promised = false;
        self.busy += length;
        self.running = Some((transfer, now + length));
    }

    /// Writes an 8-bit register.
    pub fn write(
        &mut self,
        offset: u32,
        value: u8,
        (now, bus_hz): (Ticks, u32),
        pins: &Pins,
        witness: &mut Witness,
    ) {
        match offset {
            C1 => self.write_control(value, (now, bus_hz), pins, witness),
            S => self.status &= !(value & (IICIF | ARBL)),
            D => self.write_data(value, (now, bus_hz), witness),
            _ => {
                if let Some(register) = self.registers.get_mut(offset as usize) {
                    *register = value;
                }
            }
        }
    }

    fn write_data(&mut self, value: u8, (now, bus_hz): (Ticks, u32), witness: &mut Witness) {
        let control = self.control();
        // After lost arbitration the module is no master any more; that is for software to find in S.
        if control & IICEN != 0 && control & MST == 0 && self.status & ARBL == 0 {
            witness.saw(
                Trap::I2cNotMaster,
                format!("{value:#04x} was written to D without a START before it"),
            );
        }
        if control & (IICEN | MST | TX) != IICEN | MST | TX {
            return;
        }
        if let Some((transfer, _)) = self.running
            && transfer != Transfer::Stop
        {
            witness.saw(
                Trap::I2cDataOverwritten,
                format!("{value:#04x} was written to D while a byte was still on its way"),
            );
            return;
        }
        let transfer = if self.addressing {
            Transfer::Address(value)
        } else {
            Transfer::Write(value)
        };
        // A START takes about one more bit time before the first clock.
        let bits = if self.addressing { 10 } else { 9 };
        self.addressing = false;
        self.begin(transfer, now, self.bits(bits, bus_hz));
    }

    fn write_control(
        &mut self,
        value: u8,
        (now, bus_hz): (Ticks, u32),
        pins: &Pins,
        witness: &mut Witness,
    ) {
        let before = self.control();
        self.registers[C1 as usize] = value & !RSTA;
        if value & IICEN == 0 {
            // A disabled module lets go of the bus and forgets what it was doing.
            self.running = None;
            self.addressing = false;
            self.more_promised = false;
            self.status = self.status & IICIF | TCF;
            return;
        }
        if value & !before & DMAEN != 0 && self.status & TCF != 0 {
            witness.saw(
                Trap::I2cDmaEarly,
                "DMAEN was set while TCF still stood from the byte before",
            );
        }
        let (was_master, is_master) = (before & MST != 0, value & MST != 0);
        if is_master && !was_master {
            self.start(bus_hz, pins, witness);
        } else if was_master && !is_master {
            self.end_of_reading("STOP", witness);
            self.running = Some((Transfer::Stop, now + self.bits(1, bus_hz)));
            self.addressing = false;
        } else if is_master && value & RSTA != 0 {
            if self.registers[F as usize] >> 6 != 0 {
                witness.saw(
                    Trap::I2cRepeatedStartMultiplier,
                    "a repeated START with a multiplier in I2C0_F",
                );
            }
            self.end_of_reading("repeated START", witness);
            self.addressing = true;
        } else if value & RSTA != 0 {
            witness.saw(
                Trap::I2cNotMaster,
                "a repeated START without a START before it",
            );
        }
    }

    fn start(&mut self, bus_hz: u32, pins: &Pins, witness: &mut Witness) {
        match pins.i2c_wiring() {
            Ok(()) => {}
            Err(Wiring::NotMuxed) => witness.saw(
                Trap::I2cPinMux,
                "a START while no pair of pins is connected to I2C0",
            ),
            Err(Wiring::NoPullUp) => {
                witness.saw(Trap::I2cNoPullUp, "a START on pins that nothing pulls up")
            }
        }
        let clock = time::SECOND / (self.bits(1, bus_hz) + RISE);
        if clock > FASTEST_HZ {
            witness.saw(Trap::I2cTooFast, format!("a START with SCL at {clock} Hz"));
        }
        if self.status & BUSY != 0 {
            witness.saw(
                Trap::I2cStartWhileBusy,
                "a START before the bus was free: S[BUSY] is 1",
            );
        }
        if self.status & BUSY == 0 && pins.sda() && pins.scl() {
            self.addressing = true;
            self.status |= BUSY;
        } else {
            // The bus is held by somebody else: arbitration is lost at once (46.4.1.6).
            self.status |= ARBL | IICIF;
            self.registers[C1 as usize] &= !MST;
        }
    }

    /// A master receiver ends its transfer.
    fn end_of_reading(&mut self, how: &str, witness: &mut Witness) {
        if std::mem::take(&mut self.more_promised) {
            witness.saw(
                Trap::I2cStopAfterAck,
                format!("{how} after a byte that was acknowledged: TXAK was not set in time"),
            );
        }
    }
}
