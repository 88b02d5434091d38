//! The register file: addresses, what may be written, and reset values (register map, section 3).

use std::ops::{Index, IndexMut};

pub const SELF_TEST_GYRO: u8 = 0x00;
pub const SELF_TEST_ACCEL: u8 = 0x0D;
pub const XG_OFFSET_H: u8 = 0x13;
pub const SMPLRT_DIV: u8 = 0x19;
pub const CONFIG: u8 = 0x1A;
pub const GYRO_CONFIG: u8 = 0x1B;
pub const ACCEL_CONFIG: u8 = 0x1C;
pub const ACCEL_CONFIG_2: u8 = 0x1D;
pub const LP_ACCEL_ODR: u8 = 0x1E;
pub const WOM_THR: u8 = 0x1F;
pub const FIFO_EN: u8 = 0x23;
pub const I2C_MST_CTRL: u8 = 0x24;
pub const I2C_SLV0_ADDR: u8 = 0x25;
pub const I2C_SLV4_ADDR: u8 = 0x31;
pub const I2C_SLV4_REG: u8 = 0x32;
pub const I2C_SLV4_DO: u8 = 0x33;
pub const I2C_SLV4_CTRL: u8 = 0x34;
pub const I2C_SLV4_DI: u8 = 0x35;
pub const I2C_MST_STATUS: u8 = 0x36;
pub const INT_PIN_CFG: u8 = 0x37;
pub const INT_ENABLE: u8 = 0x38;
pub const INT_STATUS: u8 = 0x3A;
pub const ACCEL_XOUT_H: u8 = 0x3B;
pub const TEMP_OUT_H: u8 = 0x41;
pub const GYRO_XOUT_H: u8 = 0x43;
pub const GYRO_ZOUT_L: u8 = 0x48;
pub const EXT_SENS_DATA_00: u8 = 0x49;
pub const EXT_SENS_DATA_23: u8 = 0x60;
pub const I2C_SLV0_DO: u8 = 0x63;
pub const I2C_MST_DELAY_CTRL: u8 = 0x67;
pub const SIGNAL_PATH_RESET: u8 = 0x68;
pub const MOT_DETECT_CTRL: u8 = 0x69;
pub const USER_CTRL: u8 = 0x6A;
pub const PWR_MGMT_1: u8 = 0x6B;
pub const PWR_MGMT_2: u8 = 0x6C;
pub const FIFO_COUNTH: u8 = 0x72;
pub const FIFO_COUNTL: u8 = 0x73;
pub const FIFO_R_W: u8 = 0x74;
pub const WHO_AM_I: u8 = 0x75;
pub const XA_OFFSET_H: u8 = 0x77;

/// What a write does to a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// It is kept.
    ReadWrite,
    /// It is ignored.
    ReadOnly,
    /// The map does not name this register.
    Reserved,
}

/// What a write does to this register.
pub fn access(register: u8) -> Access {
    match register {
        0x00..=0x02 | 0x0D..=0x0F | 0x13..=0x1F | 0x23..=0x34 | 0x37 | 0x38 | 0x63..=0x6C => {
            Access::ReadWrite
        }
        FIFO_R_W | 0x77 | 0x78 | 0x7A | 0x7B | 0x7D | 0x7E => Access::ReadWrite,
        I2C_SLV4_DI | I2C_MST_STATUS | INT_STATUS..=EXT_SENS_DATA_23 => Access::ReadOnly,
        FIFO_COUNTH | FIFO_COUNTL | WHO_AM_I => Access::ReadOnly,
        _ => Access::Reserved,
    }
}

/// The 128 registers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Registers([u8; 128]);

impl Registers {
    /// All zero, but for PWR_MGMT_1, which selects the best clock.
    pub fn new() -> Registers {
        let mut registers = Registers([0; 128]);
        registers[PWR_MGMT_1] = 0x01;
        registers
    }

    /// Whether all of `bits` are set in `register`.
    pub fn has(&self, register: u8, bits: u8) -> bool {
        self[register] & bits == bits
    }

    /// The two bits of a full-scale selection (GYRO_CONFIG and ACCEL_CONFIG).
    pub fn full_scale(&self, register: u8) -> u8 {
        self[register] >> 3 & 3
    }

    /// A signed big-endian word.
    pub fn word(&self, high: u8) -> i16 {
        i16::from_be_bytes([self[high], self[high + 1]])
    }

    /// Stores a signed word, big-endian.
    pub fn set_word(&mut self, high: u8, value: i16) {
        [self[high], self[high + 1]] = value.to_be_bytes();
    }

    /// `count` registers from `first` on.
    pub fn range(&self, first: u8, count: u8) -> &[u8] {
        &self.0[usize::from(first)..usize::from(first) + usize::from(count)]
    }
}

impl Index<u8> for Registers {
    type Output = u8;

    fn index(&self, register: u8) -> &u8 {
        &self.0[usize::from(register & 0x7F)]
    }
}

impl IndexMut<u8> for Registers {
    fn index_mut(&mut self, register: u8) -> &mut u8 {
        &mut self.0[usize::from(register & 0x7F)]
    }
}
