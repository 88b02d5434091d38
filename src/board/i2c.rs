//! I2C0 as a master (K20 manual, chapter 46): SDA on pin 18 (PTB3), SCL on pin 19 (PTB2), 375 kHz.
//!
//! Two ways to use it: [`embedded_hal::i2c::I2c`] for setting the sensor up, which waits but never
//! without a limit, and the single steps that the sampling interrupts are made of. Those let DMA fetch
//! all bytes of an answer but the last, for which the core has to set TXAK (chapter I2C, DMA support).

use embedded_hal::i2c::{self, ErrorKind, ErrorType, NoAcknowledgeSource, Operation};
use mk20dx_hal::pac;

use super::clock::Deadline;

/// SCL = bus clock / divider of ICR 0x19 = 36 MHz / 96 = 375 kHz (table 46-41). MULT must stay 0: with
/// others a repeated START may fail (erratum e6070).
const FREQUENCY: u8 = 0x19;
/// Glitch filter: three bus cycles, 83 ns; fast-mode asks for 50 ns.
const FILTER: u8 = 3;

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

/// C2.HDRS: strong drive for the pads.
const HDRS: u8 = 1 << 5;

/// A byte takes 24 µs; a slave may stretch it.
const BYTE_US: u32 = 1_000;
/// Another master does not exist; a STOP on its way takes 3 µs.
const BUSY_US: u32 = 1_000;
/// Half a clock period of the bus recovery, 100 kHz.
const HALF_PERIOD_US: u32 = 5;

const SCL: usize = 2;
const SDA: usize = 3;
const BOTH: u32 = 1 << SCL | 1 << SDA;

/// PORT_PCR: pin as I2C0 (ALT2), open drain, slow slew, high drive.
const PCR_I2C: u32 = 2 << 8 | 1 << 6 | 1 << 5 | 1 << 2;
/// PORT_PCR: pin as GPIO, open drain.
const PCR_GPIO: u32 = 1 << 8 | 1 << 5;

/// What went wrong on the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// Nobody acknowledged the address.
    NoAddress,
    /// A byte was not acknowledged.
    NoData,
    /// Somebody else drives the bus.
    ArbitrationLost,
    /// A byte did not end in time: a line is held low.
    Timeout,
    /// The transfer before has not ended.
    Busy,
    /// SDA or SCL stays low whatever is done: a short, or no pull-ups.
    Stuck,
}

impl i2c::Error for Error {
    fn kind(&self) -> ErrorKind {
        match self {
            Error::NoAddress => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address),
            Error::NoData => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data),
            Error::ArbitrationLost => ErrorKind::ArbitrationLoss,
            Error::Timeout | Error::Busy | Error::Stuck => ErrorKind::Bus,
        }
    }
}

/// The bus.
pub struct I2c {
    registers: pac::I2c0,
    port: pac::Portb,
    gpio: pac::Ptb,
}

impl I2c {
    /// Takes the module and its pins; [`I2c::recover`] has to come before the first transfer.
    pub fn new(registers: pac::I2c0, port: pac::Portb, gpio: pac::Ptb, sim: &pac::Sim) -> I2c {
        sim.scgc4().modify(|_, w| w.i2c0().enabled());
        sim.scgc5().modify(|_, w| w.portb().enabled());
        I2c {
            registers,
            port,
            gpio,
        }
    }

    /// Frees the bus and starts the module.
    ///
    /// A sensor that was in the middle of a byte when the chip was reset still holds SDA low; up to
    /// nine clocks bring it to the end of that byte, and a STOP makes it forget the rest.
    pub fn recover(&mut self) -> Result<(), Error> {
        self.control(0);
        // Outputs at 0: a pin is pulled low by making it an output and let go by making it an input.
        // SAFETY: PCOR takes any value.
        self.gpio.pcor().write(|w| unsafe { w.bits(BOTH) });
        self.release(BOTH);
        self.connect(PCR_GPIO);
        half_period();
        for _ in 0..9 {
            if self.level(SDA) {
                break;
            }
            self.pull(1 << SCL);
            half_period();
            self.release(1 << SCL);
            half_period();
        }
        // A STOP: SDA rises while SCL is high.
        self.pull(1 << SCL);
        half_period();
        self.pull(1 << SDA);
        half_period();
        self.release(1 << SCL);
        half_period();
        self.release(1 << SDA);
        half_period();
        if !self.level(SDA) || !self.level(SCL) {
            return Err(Error::Stuck);
        }
        self.connect(PCR_I2C);
        // SAFETY: a legal divider, see FREQUENCY.
        self.registers.f().write(|w| unsafe { w.bits(FREQUENCY) });
        // SAFETY: a legal filter width.
        self.registers.flt().write(|w| unsafe { w.bits(FILTER) });
        // SAFETY: HDRS is the only bit set.
        self.registers.c2().write(|w| unsafe { w.bits(HDRS) });
        self.control(IICEN);
        self.clear_flags();
        Ok(())
    }

    fn connect(&mut self, pcr: u32) {
        for pin in [SCL, SDA] {
            // SAFETY: one of the two constants above.
            self.port.pcr(pin).write(|w| unsafe { w.bits(pcr) });
        }
    }

    fn pull(&mut self, pins: u32) {
        // SAFETY: PDDR takes any value.
        self.gpio
            .pddr()
            .modify(|r, w| unsafe { w.bits(r.bits() | pins) });
    }

    fn release(&mut self, pins: u32) {
        // SAFETY: PDDR takes any value.
        self.gpio
            .pddr()
            .modify(|r, w| unsafe { w.bits(r.bits() & !pins) });
    }

    fn level(&self, pin: usize) -> bool {
        self.gpio.pdir().read().bits() >> pin & 1 != 0
    }

    #[inline(always)]
    fn control(&mut self, bits: u8) {
        // SAFETY: C1 has no reserved combination among those used here.
        self.registers.c1().write(|w| unsafe { w.bits(bits) });
    }

    #[inline(always)]
    fn status(&self) -> u8 {
        self.registers.s().read().bits()
    }

    #[inline(always)]
    fn clear_flags(&mut self) {
        // SAFETY: IICIF and ARBL are cleared by writing them as 1; the rest of S is read-only.
        self.registers
            .s()
            .write(|w| unsafe { w.bits(IICIF | ARBL) });
    }

    /// Puts a byte on the bus; its end is signalled by the interrupt flag.
    #[inline(always)]
    pub(super) fn put(&mut self, byte: u8) {
        // SAFETY: D takes any byte.
        self.registers.d().write(|w| unsafe { w.bits(byte) });
    }

    /// Takes the last byte received; while receiving this also starts the next.
    #[inline(always)]
    pub(super) fn get(&mut self) -> u8 {
        self.registers.d().read().bits()
    }

    /// START and address, with the interrupt on or off.
    #[inline(always)]
    pub(super) fn begin(&mut self, address: u8, interrupt: bool) {
        let interrupt = if interrupt { IICIE } else { 0 };
        self.clear_flags();
        self.control(IICEN | interrupt | MST | TX);
        self.put(address);
    }

    /// Whether anyone has the bus: from START to STOP, or as long as a line is held low.
    #[inline(always)]
    pub(super) fn is_busy(&self) -> bool {
        self.status() & BUSY != 0
    }

    /// Repeated START and address.
    #[inline(always)]
    pub(super) fn begin_again(&mut self, address: u8, interrupt: bool) {
        let interrupt = if interrupt { IICIE } else { 0 };
        self.control(IICEN | interrupt | MST | TX | RSTA);
        self.put(address);
    }

    /// After an acknowledged read address: turns round and clocks the first of `count` bytes.
    #[inline(always)]
    pub(super) fn receive_first(&mut self, count: usize, interrupt: bool) {
        let interrupt = if interrupt { IICIE } else { 0 };
        let refuse = if count == 1 { TXAK } else { 0 };
        self.control(IICEN | interrupt | MST | refuse);
        let _ = self.get();
    }

    /// A byte has come in and `remaining` more are wanted: takes it and sees to it that the last byte
    /// is refused, and that no byte follows it.
    #[inline(always)]
    pub(super) fn receive_next(&mut self, remaining: usize, interrupt: bool) -> u8 {
        let interrupt = if interrupt { IICIE } else { 0 };
        match remaining {
            0 => self.stop(),
            1 => self.control(IICEN | interrupt | MST | TXAK),
            _ => {}
        }
        self.get()
    }

    /// The last byte has come in and was refused: takes it without giving the bus away, for another
    /// address to follow at once.
    #[inline(always)]
    pub(super) fn receive_last_and_hold(&mut self) -> u8 {
        // Turning back to sending keeps the bus without clocking another byte.
        self.control(IICEN | MST | TX);
        self.get()
    }

    /// From here on DMA takes the bytes that come in. To be called while one is on its way.
    #[inline(always)]
    pub(super) fn hand_to_dma(&mut self) {
        self.control(IICEN | IICIE | MST | DMAEN);
    }

    /// The byte that is on its way is the last: takes it from DMA, and refuses it. True if that was too
    /// late, and it has come and was acknowledged: then another has to be read and refused.
    #[inline(always)]
    pub(super) fn refuse_last(&mut self) -> bool {
        // DMA leaves the interrupt's flag as it is, which would interrupt once DMAEN is gone.
        self.clear_flags();
        self.control(IICEN | IICIE | MST | TXAK);
        let late = self.status() & TCF != 0;
        if late {
            self.clear_flags();
        }
        late
    }

    /// STOP.
    #[inline(always)]
    pub(super) fn stop(&mut self) {
        self.control(IICEN);
    }

    /// Whether a byte has ended, and how; clears the flag.
    #[inline(always)]
    pub(super) fn byte_done(&mut self) -> Option<Result<(), Error>> {
        let status = self.status();
        if status & IICIF == 0 {
            return None;
        }
        self.clear_flags();
        Some(if status & ARBL != 0 {
            Err(Error::ArbitrationLost)
        } else if status & RXAK != 0 {
            Err(Error::NoData)
        } else {
            Ok(())
        })
    }

    /// Waits for a byte to end, for as long as it may take at most.
    fn wait(&mut self) -> Result<(), Error> {
        let deadline = Deadline::in_us(BYTE_US);
        loop {
            if let Some(result) = self.byte_done() {
                return result;
            }
            if deadline.passed() {
                return Err(Error::Timeout);
            }
        }
    }

    fn wait_until_free(&mut self) -> Result<(), Error> {
        let deadline = Deadline::in_us(BUSY_US);
        while self.is_busy() {
            if deadline.passed() {
                return Err(Error::Timeout);
            }
        }
        Ok(())
    }

    fn address(&mut self, first: bool, byte: u8) -> Result<(), Error> {
        if first {
            self.wait_until_free()?;
            self.begin(byte, false);
        } else {
            self.begin_again(byte, false);
        }
        self.wait().map_err(|error| {
            if error == Error::NoData {
                Error::NoAddress
            } else {
                error
            }
        })
    }

    /// Operations of one kind that follow each other are one transfer; between the two kinds comes a
    /// repeated START (the contract of [`embedded_hal::i2c::I2c::transaction`]).
    #[inline(never)] // the set-up has forty transfers, and this would be in the image as often
    fn run(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Error> {
        let mut writing = None;
        let mut to_read = 0;
        for index in 0..operations.len() {
            let (done, rest) = operations.split_at_mut(index + 1);
            match &mut done[index] {
                Operation::Write(bytes) => {
                    if writing != Some(true) {
                        self.address(writing.is_none(), address << 1)?;
                        writing = Some(true);
                    }
                    for &byte in bytes.iter() {
                        self.put(byte);
                        self.wait()?;
                    }
                }
                Operation::Read(bytes) => {
                    let following = count_of_leading_reads(rest);
                    if writing != Some(false) {
                        to_read = bytes.len() + following;
                        if to_read == 0 {
                            continue;
                        }
                        self.address(writing.is_none(), address << 1 | 1)?;
                        writing = Some(false);
                        self.receive_first(to_read, false);
                    }
                    let ends_here = rest
                        .iter()
                        .all(|operation| matches!(operation, Operation::Read(_)));
                    for byte in bytes.iter_mut() {
                        match self.wait() {
                            // RXAK reflects our own refusal of the last byte.
                            Ok(()) | Err(Error::NoData) => {}
                            Err(error) => return Err(error),
                        }
                        to_read -= 1;
                        *byte = if to_read == 0 && !ends_here {
                            self.receive_last_and_hold()
                        } else {
                            self.receive_next(to_read, false)
                        };
                    }
                }
            }
        }
        Ok(())
    }
}

fn count_of_leading_reads(operations: &[Operation<'_>]) -> usize {
    operations
        .iter()
        .map_while(|operation| match operation {
            Operation::Read(bytes) => Some(bytes.len()),
            Operation::Write(_) => None,
        })
        .sum()
}

fn half_period() {
    Deadline::in_us(HALF_PERIOD_US).wait();
}

impl ErrorType for I2c {
    type Error = Error;
}

impl i2c::I2c for I2c {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Error> {
        let result = self.run(address, operations);
        self.stop();
        if result == Err(Error::Timeout) {
            // Leaves the bus as it found it, for the next try.
            let _ = self.recover();
        }
        result
    }
}
