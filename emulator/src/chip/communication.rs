//! The serial interfaces beside USB and the sensor bus, and the pins they talk over.

use crate::journal::Journal;
use crate::peripherals::clocks::Clocks;
use crate::peripherals::i2c::{I2c, Target};
use crate::peripherals::pins::Pins;
use crate::peripherals::spi::Spi;
use crate::peripherals::uart::Uart;
use crate::time::{NEVER, Ticks};
use crate::witness::Witness;

/// Pins of UART0 to UART2, all with MUX 3: interface, transmits, port (A is 0), bit (K20 manual, chapter "Signal
/// Multiplexing").
const PINS: [(usize, bool, usize, u32); 10] = [
    (0, false, 1, 16),
    (0, true, 1, 17),
    (0, false, 3, 6),
    (0, true, 3, 7),
    (1, false, 2, 3),
    (1, true, 2, 4),
    (1, false, 4, 1),
    (1, true, 4, 0),
    (2, false, 3, 2),
    (2, true, 3, 3),
];
const MUX: u32 = 3;

/// Nothing: an I2C bus without devices.
struct Nobody;

impl Target for Nobody {
    fn address(&mut self, _byte: u8, _now: Ticks) -> bool {
        false
    }

    fn write(&mut self, _byte: u8, _now: Ticks) -> bool {
        false
    }

    fn read(&mut self, _now: Ticks) -> u8 {
        0xFF
    }

    fn stop(&mut self) {}
}

/// UART0 to UART2, SPI0 and I2C1.
#[derive(Debug, Clone)]
pub struct Communication {
    /// UART0 to UART2: Serial1 to Serial3 of a Teensy.
    pub uarts: [Uart; 3],
    /// SPI0.
    pub spi: Spi,
    /// I2C1, to which nothing is connected.
    pub(super) i2c1: I2c,
}

impl Communication {
    pub(super) fn new() -> Communication {
        Communication {
            uarts: [Uart::new(8), Uart::new(8), Uart::new(1)],
            spi: Spi::new(),
            i2c1: I2c::new(),
        }
    }

    pub(super) fn reset(&mut self) {
        self.uarts.iter_mut().for_each(Uart::reset);
        self.spi.reset();
        self.i2c1 = I2c::new();
    }

    /// UART0 and UART1 run from the core clock, UART2 from the bus clock.
    pub(super) fn uart_hz(n: usize, clocks: &Clocks) -> u32 {
        if n < 2 { clocks.core_hz } else { clocks.bus_hz }
    }

    fn connected(pins: &Pins, n: usize, transmits: bool) -> bool {
        PINS.iter().any(|&(uart, direction, port, bit)| {
            (uart, direction) == (n, transmits) && pins.function(port, bit) == MUX
        })
    }

    /// Puts bytes on the receive line of UART `n`; `false` if no pin is connected to it.
    pub(super) fn receive(&mut self, n: usize, bytes: &[u8], pins: &Pins, clocks: &Clocks) -> bool {
        let connected = Communication::connected(pins, n, false);
        if connected {
            self.uarts[n].receive(bytes, clocks.now, Communication::uart_hz(n, clocks));
        }
        connected
    }

    pub(super) fn next_event(&self) -> Ticks {
        self.uarts
            .iter()
            .map(Uart::next_event)
            .fold(NEVER, Ticks::min)
            .min(self.spi.next_event())
            .min(self.i2c1.next_event())
    }

    pub(super) fn advance(&mut self, pins: &Pins, clocks: &Clocks, witness: &mut Witness) {
        for (n, uart) in self.uarts.iter_mut().enumerate() {
            if uart.next_event() <= clocks.now {
                let connected = Communication::connected(pins, n, true);
                uart.advance(clocks.now, Communication::uart_hz(n, clocks), connected);
            }
        }
        self.spi.advance(clocks);
        if self.i2c1.next_event() <= clocks.now {
            self.i2c1.advance(
                (clocks.now, clocks.bus_hz),
                &pins.second_bus(),
                &mut Nobody,
                &mut Journal::default(),
                witness,
            );
        }
    }
}
