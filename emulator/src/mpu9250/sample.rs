//! What happens with a sample: output registers, FIFO, wake on motion, auxiliary bus, data ready.

use super::aux_master::AuxiliaryBus;
use super::interrupts;
use super::registers::*;
use super::sampling::Mode;
use super::{FIFO_ENABLED, FIFO_MODE, I2C_MST_EN, Mpu9250, WAKE_ON_MOTION};
use crate::time::Ticks;

/// WAIT_FOR_ES and SLV_3_FIFO_EN of I2C_MST_CTRL.
const WAIT_FOR_ES: u8 = 1 << 6;
const SLV_3_FIFO_EN: u8 = 1 << 5;

impl Mpu9250 {
    /// Stores a sample.
    pub(super) fn sample(&mut self, at: Ticks) {
        self.last_ready = at;
        let counts = self.path.counts(&self.registers);
        let before = [0, 2, 4].map(|offset| self.registers.word(ACCEL_XOUT_H + offset));
        for (axis, value) in (0..).zip(counts.accel) {
            self.registers.set_word(ACCEL_XOUT_H + 2 * axis, value);
        }
        if self.clock.schedule().mode == Mode::Running {
            self.registers.set_word(TEMP_OUT_H, counts.temperature);
            for (axis, value) in (0..).zip(counts.gyro) {
                self.registers.set_word(GYRO_XOUT_H + 2 * axis, value);
            }
        }
        self.sample_fsync();
        if self.registers.has(MOT_DETECT_CTRL, WAKE_ON_MOTION) {
            self.watch_motion(before, counts.accel, at);
        }
        self.aux.finish(&mut self.registers, at);
        self.store_in_fifo(at);
        // A sample before this one may still have to be announced.
        self.announce_external(at);
        let mut ready_at = at;
        if self.registers.has(USER_CTRL, I2C_MST_EN) {
            let mut bus = AuxiliaryBus {
                magnetometer: self.magnetometer.as_mut(),
                complaints: &mut self.complaints,
            };
            self.aux.sample(&mut self.registers, at, &mut bus);
            if self.registers.has(I2C_MST_CTRL, WAIT_FOR_ES) {
                ready_at = self.aux.busy_until().max(at);
            }
        }
        if ready_at > at {
            self.ready_with_external = Some(ready_at);
        } else {
            self.interrupts
                .raise(interrupts::RAW_DATA_RDY, &self.registers, at);
        }
    }

    /// Wake on motion: any axis has changed by more than the threshold since the sample before (PS 6.1, RM 4.10).
    fn watch_motion(&mut self, before: [i16; 3], after: [i16; 3], at: Ticks) {
        /// Weight of WOM_THR (g).
        const WEIGHT: f64 = 0.004;
        let counts_per_g = 16_384.0 / f64::from(1 << self.registers.full_scale(ACCEL_CONFIG));
        let threshold = f64::from(self.registers[WOM_THR]) * WEIGHT * counts_per_g;
        let moved = before
            .into_iter()
            .zip(after)
            .any(|(before, after)| f64::from(before.abs_diff(after)) > threshold);
        if moved {
            self.interrupts.raise(interrupts::WOM, &self.registers, at);
        }
    }

    /// Appends the enabled output registers in the order of their numbers (RM 4.11 and 4.37).
    fn store_in_fifo(&mut self, at: Ticks) {
        if !self.registers.has(USER_CTRL, FIFO_ENABLED) {
            return;
        }
        let enable = self.registers[FIFO_EN];
        let mut ranges = Vec::with_capacity(9);
        if enable & 0x08 != 0 {
            ranges.push((ACCEL_XOUT_H, 6));
        }
        if enable & 0x80 != 0 {
            ranges.push((TEMP_OUT_H, 2));
        }
        for axis in 0..3 {
            if enable & 0x40 >> axis != 0 {
                ranges.push((GYRO_XOUT_H + 2 * axis, 2));
            }
        }
        for slave in 0..4 {
            let enabled = match slave {
                3 => self.registers.has(I2C_MST_CTRL, SLV_3_FIFO_EN),
                _ => enable >> slave & 1 != 0,
            };
            let (first, length) = self.aux.allocation(slave);
            if enabled {
                ranges.push((EXT_SENS_DATA_00 + first, length));
            }
        }
        let keep = self.registers.has(CONFIG, FIFO_MODE);
        let mut lost = false;
        for (first, length) in ranges {
            for byte in self.registers.range(first, length) {
                lost |= self.fifo.push(*byte, keep);
            }
        }
        if lost {
            self.interrupts
                .raise(interrupts::FIFO_OFLOW, &self.registers, at);
        }
    }

    /// Data ready that had to wait for external sensor data (WAIT_FOR_ES, RM 4.12).
    pub(super) fn announce_external(&mut self, now: Ticks) {
        if let Some(at) = self.ready_with_external.filter(|&at| at <= now) {
            self.ready_with_external = None;
            self.interrupts
                .raise(interrupts::RAW_DATA_RDY, &self.registers, at);
        }
    }

    /// EXT_SYNC_SET puts the level of FSYNC into a last bit (RM 4.5); the board ties the pin to ground.
    fn sample_fsync(&mut self) {
        let low_byte = match self.registers[CONFIG] >> 3 & 7 {
            0 => return,
            1 => TEMP_OUT_H + 1,
            axis @ 2..=4 => GYRO_XOUT_H + 2 * (axis - 2) + 1,
            axis => ACCEL_XOUT_H + 2 * (axis - 5) + 1,
        };
        self.registers[low_byte] &= !1;
    }
}
