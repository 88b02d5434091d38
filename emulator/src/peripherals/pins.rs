//! Ports and GPIO (K20 manual, chapters 11 and 49), and the two wires of the sensor bus with their pull-ups.
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

#[derive(Debug, Clone, Default)]
struct Port {
    control: [u32; 32],
    output: u32,
    direction: u32,
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
        self.ports = Default::default();
    }

    fn mux(&self, bit: u32) -> u32 {
        self.ports[PORT_B].control[bit as usize] >> 8 & 7
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
        if offset < 0x80 {
            self.ports[index].control[offset as usize / 4]
        } else {
            0
        }
    }

    /// Writes a pin control register of port `index`.
    pub fn write_port(&mut self, index: usize, offset: u32, value: u32) {
        let scl_before = self.scl();
        if offset < 0x80 {
            self.ports[index].control[offset as usize / 4] = value & !(1 << 24);
        }
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
            0x10 if index == PORT_B => {
                let driven = port.output & port.direction;
                driven & !(1 << SCL | 1 << SDA)
                    | u32::from(self.scl()) << SCL
                    | u32::from(self.sda()) << SDA
            }
            0x10 => port.output & port.direction,
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
        self.clock(scl_before);
    }

    /// A rising edge on SCL brings a sensor that is stuck in the middle of a byte one bit further.
    fn clock(&mut self, scl_before: bool) {
        if !scl_before && self.scl() {
            self.sda_held_for = self.sda_held_for.saturating_sub(1);
        }
    }
}
