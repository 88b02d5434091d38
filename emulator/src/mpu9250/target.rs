//! The bus interface: registers as a master sees them (PS 7.2 and 7.3).

use super::complaint::Complaint;
use super::interrupts::RAW_DATA_RDY;
use super::registers::*;
use super::{ADDRESS, Burst, FIFO_ENABLED, Mpu9250, RESET_TIME, ak8963};
use crate::peripherals::i2c::Target;
use crate::time::Ticks;

const H_RESET: u8 = 1 << 7;
/// Bits of USER_CTRL that clear themselves.
const I2C_IF_DIS: u8 = 1 << 4;
const FIFO_RST: u8 = 1 << 2;
const I2C_MST_RST: u8 = 1 << 1;
const SIG_COND_RST: u8 = 1 << 0;

/// Output registers and external sensor data: they hold still while they are read (RM 4.22, "SyncR").
const SHADOWED: usize = (EXT_SENS_DATA_23 - ACCEL_XOUT_H) as usize + 1;

/// INT_STATUS to GYRO_ZOUT_L.
const BURST: usize = 15;

/// Whom the running transfer is with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Partner {
    #[default]
    Nobody,
    Registers,
    /// The magnetometer, through the bypass.
    Magnetometer,
}

/// A burst from INT_STATUS on that is being read.
#[derive(Debug, Clone)]
struct Reading {
    at: Ticks,
    ready: Ticks,
    bytes: Vec<u8>,
}

/// The transfer on the bus.
#[derive(Debug, Clone)]
pub struct Transfer {
    partner: Partner,
    pointer: u8,
    first_byte: bool,
    /// Output registers as this transfer sees them.
    shadow: [u8; SHADOWED],
    burst: Option<Reading>,
    /// What is being read of the magnetometer.
    field: Vec<u8>,
}

impl Default for Transfer {
    fn default() -> Transfer {
        Transfer {
            partner: Partner::Nobody,
            pointer: 0,
            first_byte: false,
            shadow: [0; SHADOWED],
            burst: None,
            field: Vec::new(),
        }
    }
}

impl Mpu9250 {
    fn read_register(&mut self, register: u8, now: Ticks) -> u8 {
        let byte = match register {
            INT_STATUS => return self.interrupts.read_status(),
            ACCEL_XOUT_H..=EXT_SENS_DATA_23 => {
                let driven = super::gyro_driven(&self.registers);
                if (GYRO_XOUT_H..=GYRO_ZOUT_L).contains(&register)
                    && driven
                    && now < self.started.gyro
                {
                    self.complain(now, Complaint::GyroNotStarted);
                }
                self.transfer.shadow[usize::from(register - ACCEL_XOUT_H)]
            }
            I2C_MST_STATUS => self.aux.read_status(),
            FIFO_COUNTH => {
                self.advance(now);
                self.fifo.count_high()
            }
            FIFO_COUNTL => self.fifo.count_low(),
            FIFO_R_W => self.read_fifo(now),
            _ => self.registers[register],
        };
        self.interrupts.any_read(&self.registers);
        byte
    }

    fn read_fifo(&mut self, now: Ticks) -> u8 {
        self.advance(now);
        if !self.registers.has(USER_CTRL, FIFO_ENABLED) {
            self.complain(now, Complaint::FifoDisabled);
            return self.fifo.last();
        }
        self.fifo.pop().unwrap_or_else(|last| {
            self.complaints.note(now, Complaint::FifoEmpty);
            last
        })
    }

    fn write_register(&mut self, register: u8, value: u8, now: Ticks) {
        match access(register) {
            Access::ReadWrite => {}
            Access::ReadOnly => {
                return self.complain(now, Complaint::ReadOnlyRegister(register));
            }
            Access::Reserved => {
                return self.complain(now, Complaint::ReservedRegister(register));
            }
        }
        let before = self.registers.clone();
        self.registers[register] = value;
        match register {
            PWR_MGMT_1 if value & H_RESET != 0 => {
                self.reset_registers(now);
                self.answers_at = now + RESET_TIME;
                self.reset_by_driver = true;
            }
            PWR_MGMT_1 | PWR_MGMT_2 => {
                self.start_elements(&before, now);
                self.follow_registers(now);
            }
            LP_ACCEL_ODR => {
                if value & 0xF > 11 {
                    self.complain(now, Complaint::ReservedAccelRate(value & 0xF));
                }
                self.follow_registers(now);
            }
            SMPLRT_DIV | CONFIG | GYRO_CONFIG | ACCEL_CONFIG_2 => self.follow_registers(now),
            I2C_SLV0_ADDR..I2C_SLV4_ADDR => self.aux.reallocate(&self.registers),
            SIGNAL_PATH_RESET => {
                self.path.reset(value);
                self.registers[SIGNAL_PATH_RESET] = 0;
            }
            USER_CTRL => self.control(value, now),
            FIFO_R_W if self.registers.has(USER_CTRL, FIFO_ENABLED) => {
                let keep = self.registers.has(CONFIG, super::FIFO_MODE);
                self.fifo.push(value, keep);
            }
            _ => {}
        }
    }

    /// USER_CTRL: what happens once (RM 4.33).
    fn control(&mut self, value: u8, now: Ticks) {
        if value & FIFO_RST != 0 {
            self.fifo.clear();
        }
        if value & I2C_MST_RST != 0 {
            if self.aux.is_busy(now) {
                self.complain(now, Complaint::MasterResetWhileBusy);
            }
            self.aux.reset(now);
        }
        if value & SIG_COND_RST != 0 {
            self.path.reset(7);
            for register in ACCEL_XOUT_H..=EXT_SENS_DATA_23 {
                self.registers[register] = 0;
            }
        }
        if value & I2C_IF_DIS != 0 {
            self.complain(now, Complaint::I2cDisabled);
            self.spi_only = true;
        }
        self.registers[USER_CTRL] = value & !(I2C_IF_DIS | FIFO_RST | I2C_MST_RST | SIG_COND_RST);
    }

    fn is_addressed(&mut self, byte: u8, now: Ticks) -> Partner {
        let address = byte >> 1;
        if self.faults.absent {
            return Partner::Nobody;
        }
        if address == ak8963::ADDRESS && self.is_bypassed() && now >= self.answers_at {
            return match &mut self.magnetometer {
                Some(magnetometer) if magnetometer.answers() => {
                    magnetometer.address();
                    Partner::Magnetometer
                }
                _ => Partner::Nobody,
            };
        }
        if address != ADDRESS || self.spi_only {
            return Partner::Nobody;
        }
        if now < self.answers_at {
            // At power-on a host cannot know; after a reset it asked for, it can.
            if self.reset_by_driver {
                self.complain(now, Complaint::BusyAfterReset);
            }
            return Partner::Nobody;
        }
        Partner::Registers
    }

    fn end_burst(&mut self) {
        if let Some(Reading { at, ready, bytes }) = self.transfer.burst.take()
            && let Some(recording) = &mut self.recording
            && let Ok(bytes) = bytes.try_into()
        {
            recording.push(Burst {
                at,
                ready,
                bytes,
                field: None,
            });
        }
        if let Ok(field) = std::mem::take(&mut self.transfer.field).try_into()
            && let Some(last) = self.recording.as_mut().and_then(|all| all.last_mut())
        {
            last.field = Some(field);
        }
    }
}

impl Target for Mpu9250 {
    fn address(&mut self, byte: u8, now: Ticks) -> bool {
        self.end_burst();
        self.transfer.partner = self.is_addressed(byte, now);
        if self.transfer.partner == Partner::Registers {
            self.transfer.first_byte = true;
            self.advance(now);
            self.transfer
                .shadow
                .copy_from_slice(self.registers.range(ACCEL_XOUT_H, SHADOWED as u8));
            if byte & 1 != 0 && self.transfer.pointer == INT_STATUS {
                self.transfer.burst = Some(Reading {
                    at: now,
                    ready: self.last_ready,
                    bytes: Vec::with_capacity(BURST),
                });
            }
        }
        self.transfer.partner != Partner::Nobody
    }

    fn write(&mut self, byte: u8, now: Ticks) -> bool {
        match self.transfer.partner {
            _ if self.faults.absent => return false,
            Partner::Nobody => return false,
            Partner::Magnetometer => {
                if let Some(magnetometer) = &mut self.magnetometer {
                    magnetometer.write(byte, now, &mut self.complaints);
                }
            }
            Partner::Registers if std::mem::take(&mut self.transfer.first_byte) => {
                self.transfer.pointer = byte & 0x7F;
            }
            Partner::Registers => {
                self.advance(now);
                self.write_register(self.transfer.pointer, byte, now);
                self.transfer.next();
            }
        }
        true
    }

    fn read(&mut self, now: Ticks) -> u8 {
        match self.transfer.partner {
            _ if self.faults.absent => 0xFF,
            Partner::Nobody => 0xFF,
            Partner::Magnetometer => match &mut self.magnetometer {
                Some(magnetometer) => {
                    let byte = magnetometer.read(now, &mut self.complaints);
                    self.transfer.field.push(byte);
                    byte
                }
                None => 0xFF,
            },
            Partner::Registers => {
                let byte = self.read_register(self.transfer.pointer, now);
                self.transfer.next();
                if let Some(Reading { ready, bytes, .. }) = &mut self.transfer.burst {
                    bytes.push(byte);
                    if bytes.len() == BURST && bytes[0] & RAW_DATA_RDY != 0 {
                        self.fetched = Some(*ready);
                    }
                }
                byte
            }
        }
    }

    fn stop(&mut self) {
        self.end_burst();
        self.transfer.partner = Partner::Nobody;
    }
}

impl Transfer {
    /// The next register; FIFO_R_W stays, so that it can be read in a burst (PS 4.17).
    fn next(&mut self) {
        if self.pointer != FIFO_R_W {
            self.pointer = (self.pointer + 1) & 0x7F;
        }
    }
}
