//! Ports and GPIO (K20 manual, chapters 11 and 49): directions, levels, pulls and pin interrupts; and the two wires of
//! the sensor bus with their pull-ups.
//!
//! I2C0 reaches two pairs of port B's pins: PTB2 and PTB3, to which the board's sensor and its pull-ups are soldered,
//! and PTB0 and PTB1, to which nothing is.

const PORT_B: usize = 1;
/// SCL is PTB2, pin 19 of the board.
const SCL: u32 = 2;
/// SDA is PTB3, pin 18 of the board.
const SDA: u32 = 3;
/// The other pair: SCL is PTB0, pin 16 of the board, and SDA is PTB1, pin 17.
const OTHER: [u32; 2] = [0, 1];
const MUX_GPIO: u32 = 1;
const MUX_I2C: u32 = 2;
/// PORTx_PCRn: pull enabled, and upwards.
const PULL_UP: u32 = 0b11;

/// Pin control: pull direction, pull enable, open drain, and the interrupt flag.
const PS: u32 = 1 << 0;
const PE: u32 = 1 << 1;
const ODE: u32 = 1 << 5;
const ISF: u32 = 1 << 24;

/// Registers of a port behind its pin control registers: global pin control, interrupt flags.
const GPCLR: u32 = 0x80;
const GPCHR: u32 = 0x84;
const ISFR: u32 = 0xA0;

#[derive(Debug, Clone, Default)]
struct Port {
    control: [u32; 32],
    output: u32,
    direction: u32,
    /// Pins that raise a flag, and the levels that were seen there last.
    watched: u32,
    seen: u32,
    flags: u32,
    /// Pins that something outside drives, and to which level.
    driven: u32,
    driven_high: u32,
    /// Levels that peripherals put out.
    peripheral: u32,
}

impl Port {
    fn mux(&self, bit: u32) -> u32 {
        self.control[bit as usize] >> 8 & 7
    }

    /// Level of a pin: its own output, else what drives it from outside, else its pull, else low.
    fn level(&self, bit: u32) -> bool {
        let control = self.control[bit as usize];
        let at = |register: u32| register >> bit & 1 != 0;
        let undriven = if at(self.driven) {
            at(self.driven_high)
        } else {
            control & (PE | PS) == PE | PS
        };
        match self.mux(bit) {
            MUX_GPIO if at(self.direction) && (control & ODE == 0 || !at(self.output)) => {
                at(self.output)
            }
            0 | MUX_GPIO => undriven,
            _ => at(self.peripheral) || undriven,
        }
    }

    /// Raises the flags of edges and levels (PCR[IRQC]).
    fn look(&mut self) {
        for bit in (0..32).filter(|&bit| self.watched >> bit & 1 != 0) {
            let (before, now) = (self.seen >> bit & 1 != 0, self.level(bit));
            let raised = match self.control[bit as usize] >> 16 & 0xF {
                1 | 9 => now && !before,
                2 | 0xA => before && !now,
                3 | 0xB => before != now,
                8 => !now,
                0xC => now,
                _ => false,
            };
            self.flags |= u32::from(raised) << bit;
            self.seen = self.seen & !(1 << bit) | u32::from(now) << bit;
        }
    }

    fn set_control(&mut self, bit: u32, value: u32) {
        if value & ISF != 0 {
            self.flags &= !(1 << bit);
        }
        let old = std::mem::replace(&mut self.control[bit as usize], value & !ISF);
        let watched = value >> 16 & 0xF != 0;
        self.watched = self.watched & !(1 << bit) | u32::from(watched) << bit;
        if old >> 16 & 0xF == 0 {
            // What the pin is at when its interrupt is switched on is no edge.
            self.seen = self.seen & !(1 << bit) | u32::from(self.level(bit)) << bit;
        }
    }

    /// Flags of pins whose IRQC asks for an interrupt, or for DMA.
    fn asking(&self, dma: bool) -> bool {
        let kind = |bit: u32| self.control[bit as usize] >> 16 & 0xF;
        (0..32).any(|bit| self.flags >> bit & 1 != 0 && (kind(bit) < 8) == dma && kind(bit) != 0)
    }
}

/// Ports A to E.
#[derive(Debug, Clone, Default)]
pub struct Pins {
    ports: [Port; 5],
    /// SCL pulses after which a sensor that holds SDA low lets go of it.
    pub sda_held_for: u32,
    /// Something holds SCL low, whatever anybody does.
    pub scl_held: bool,
    /// The board's pull-ups on SCL and SDA are missing.
    pub no_pull_ups: bool,
}

/// What is wrong with the pins of the sensor bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wiring {
    /// No pair of pins is connected to I2C0.
    NotMuxed,
    /// Nothing pulls up the pins that are.
    NoPullUp,
}

impl Pins {
    /// After a system reset; what is wired to the pins stays as it is.
    pub fn reset(&mut self) {
        for port in &mut self.ports {
            *port = Port {
                driven: port.driven,
                driven_high: port.driven_high,
                ..Port::default()
            };
        }
    }

    /// Drives a pin from outside, or lets go of it.
    pub fn drive(&mut self, port: usize, bit: u32, level: Option<bool>) {
        let port = &mut self.ports[port];
        port.driven = port.driven & !(1 << bit) | u32::from(level.is_some()) << bit;
        port.driven_high = port.driven_high & !(1 << bit) | u32::from(level == Some(true)) << bit;
        port.look();
    }

    /// What a peripheral puts out on a pin that is connected to it.
    pub fn set_peripheral_level(&mut self, port: usize, bit: u32, level: bool) {
        let port = &mut self.ports[port];
        port.peripheral = port.peripheral & !(1 << bit) | u32::from(level) << bit;
    }

    /// Level of a pin.
    pub fn level(&self, port: usize, bit: u32) -> bool {
        match (port, bit) {
            (PORT_B, SCL) => self.scl(),
            (PORT_B, SDA) => self.sda(),
            _ => self.ports[port].level(bit),
        }
    }

    /// Which peripheral a pin is connected to (MUX of its PCR).
    pub fn function(&self, port: usize, bit: u32) -> u32 {
        self.ports[port].mux(bit)
    }

    /// Whether port `index` asks for its interrupt.
    pub fn interrupt(&self, index: usize) -> bool {
        self.ports[index].flags != 0 && self.ports[index].asking(false)
    }

    /// Whether port `index` asks for DMA.
    pub fn dma_request(&self, index: usize) -> bool {
        self.ports[index].flags != 0 && self.ports[index].asking(true)
    }

    /// A DMA transfer for port `index` has ended, which clears its flags.
    pub fn dma_done(&mut self, index: usize) {
        self.ports[index].flags = 0;
    }

    fn mux(&self, bit: u32) -> u32 {
        self.ports[PORT_B].mux(bit)
    }

    /// Whether both bus pins are connected to I2C0.
    pub fn i2c_connected(&self) -> bool {
        self.mux(SCL) == MUX_I2C && self.mux(SDA) == MUX_I2C
    }

    /// What a START would find wrong with the pins of I2C0.
    pub fn i2c_wiring(&self) -> Result<(), Wiring> {
        let control = |bit: u32| self.ports[PORT_B].control[bit as usize];
        let pulled = |bit: u32| control(bit) & PULL_UP == PULL_UP;
        if self.i2c_connected() {
            let pulled_up = !self.no_pull_ups || [SCL, SDA].into_iter().all(pulled);
            return if pulled_up {
                Ok(())
            } else {
                Err(Wiring::NoPullUp)
            };
        }
        if OTHER.into_iter().any(|bit| self.mux(bit) != MUX_I2C) {
            Err(Wiring::NotMuxed)
        } else if OTHER.into_iter().all(pulled) {
            Ok(())
        } else {
            Err(Wiring::NoPullUp)
        }
    }

    /// What I2C1 sees of its pins, PTC10 and PTC11, in the place of the sensor bus's: nothing pulls them up.
    pub fn second_bus(&self) -> Pins {
        let mut pins = Pins {
            no_pull_ups: true,
            ..Pins::default()
        };
        pins.ports[PORT_B].control[SCL as usize] = self.ports[2].control[10];
        pins.ports[PORT_B].control[SDA as usize] = self.ports[2].control[11];
        pins
    }

    fn driven_low(&self, bit: u32) -> bool {
        let port = &self.ports[PORT_B];
        self.mux(bit) == MUX_GPIO && port.direction >> bit & 1 != 0 && port.output >> bit & 1 == 0
    }

    fn pulled_up(&self, bit: u32) -> bool {
        !self.no_pull_ups || self.ports[PORT_B].control[bit as usize] & PULL_UP == PULL_UP
    }

    /// Level of the data line: pulled up unless somebody holds it low.
    pub fn sda(&self) -> bool {
        !self.driven_low(SDA) && self.sda_held_for == 0 && self.pulled_up(SDA)
    }

    /// Level of the clock line.
    pub fn scl(&self) -> bool {
        !self.driven_low(SCL) && !self.scl_held && self.pulled_up(SCL)
    }

    /// Reads a pin control register of port `index`.
    pub fn read_port(&self, index: usize, offset: u32) -> u32 {
        let port = &self.ports[index];
        match offset {
            0..GPCLR => {
                let bit = offset / 4;
                port.control[bit as usize] | if port.flags >> bit & 1 != 0 { ISF } else { 0 }
            }
            ISFR => port.flags,
            _ => 0,
        }
    }

    /// Writes a pin control register of port `index`.
    pub fn write_port(&mut self, index: usize, offset: u32, value: u32) {
        let scl_before = self.scl();
        let port = &mut self.ports[index];
        match offset {
            0..GPCLR => port.set_control(offset / 4, value),
            // The lower half of the control register, for all pins named in the upper half of the value.
            GPCLR | GPCHR => {
                let first = if offset == GPCLR { 0 } else { 16 };
                for bit in (0..16).filter(|bit| value >> (16 + bit) & 1 != 0) {
                    let control = port.control[first + bit];
                    port.set_control((first + bit) as u32, control & 0xFFFF_0000 | value & 0xFFFF);
                }
            }
            ISFR => port.flags &= !value,
            _ => {}
        }
        port.look();
        self.clock(scl_before);
    }

    /// Reads a GPIO register; offsets count from 0x400F_F000.
    pub fn read_gpio(&self, offset: u32) -> u32 {
        let index = offset as usize / 0x40;
        let Some(port) = self.ports.get(index) else {
            return 0;
        };
        match offset % 0x40 {
            0x00 => port.output,
            // Pins without a digital function read 0.
            0x10 => (0..32)
                .filter(|&bit| self.ports[index].mux(bit) != 0 && self.level(index, bit))
                .map(|bit| 1 << bit)
                .sum(),
            0x14 => port.direction,
            _ => 0,
        }
    }

    /// Writes a GPIO register.
    pub fn write_gpio(&mut self, offset: u32, value: u32) {
        let scl_before = self.scl();
        let Some(port) = self.ports.get_mut(offset as usize / 0x40) else {
            return;
        };
        match offset % 0x40 {
            0x00 => port.output = value,
            0x04 => port.output |= value,
            0x08 => port.output &= !value,
            0x0C => port.output ^= value,
            0x14 => port.direction = value,
            _ => {}
        }
        port.look();
        self.clock(scl_before);
    }

    /// A rising edge on SCL brings a sensor that is stuck in the middle of a byte one bit further.
    fn clock(&mut self, scl_before: bool) {
        if !scl_before && self.scl() {
            self.sda_held_for = self.sda_held_for.saturating_sub(1);
        }
    }
}

/// Port and bit of the board's pins 0 to 33, as its schematic has them.
const BOARD: [(usize, u32); 34] = [
    (1, 16),
    (1, 17),
    (3, 0),
    (0, 12),
    (0, 13),
    (3, 7),
    (3, 4),
    (3, 2),
    (3, 3),
    (2, 3),
    (2, 4),
    (2, 6),
    (2, 7),
    (2, 5),
    (3, 1),
    (2, 0),
    (1, 0),
    (1, 1),
    (1, 3),
    (1, 2),
    (3, 5),
    (3, 6),
    (2, 1),
    (2, 2),
    (0, 5),
    (1, 19),
    (4, 1),
    (2, 9),
    (2, 8),
    (2, 10),
    (2, 11),
    (4, 0),
    (1, 18),
    (0, 4),
];

/// Port (A is 0) and bit of pin `number` of the board.
pub fn board_pin(number: u8) -> Option<(usize, u32)> {
    BOARD.get(usize::from(number)).copied()
}
