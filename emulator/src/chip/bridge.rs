//! The peripheral bridges: which module answers an access of the processor.

use super::Chip;
use super::slots::{SLOTS, Slot};
use crate::journal::Happening;
use crate::witness::Trap;

/// The miscellaneous control module stands on the processor's private bus, beyond the bridges.
const MCM: u32 = 0xE008_0000;

impl Chip {
    fn find(&mut self, address: u32, width: u8, write: bool) -> Option<&'static Slot> {
        let page = address >> 12 & 0xFF;
        let what = if write { "write to" } else { "read of" };
        let Some(slot) = SLOTS.iter().find(|slot| slot.page == page) else {
            self.witness.saw(
                Trap::UnmappedPeripheral,
                format!("{what} {address:#010x}: this chip has no peripheral there"),
            );
            return None;
        };
        if slot.gate.is_some_and(|(n, bit)| !self.sim.gate(n, bit)) {
            let (n, bit) = slot.gate.unwrap_or_default();
            self.witness.saw(
                Trap::ClockGated,
                format!(
                    "{what} {address:#010x} ({}) while its clock is off: bit {bit} of SIM_SCGC{n} is 0",
                    slot.name
                ),
            );
            return None;
        }
        if slot.width != 0 && slot.width != width {
            self.witness.saw(
                Trap::AccessWidth,
                format!(
                    "{what} {address:#010x} ({}), {} bits wide; its registers have {}",
                    slot.name,
                    width * 8,
                    slot.width * 8
                ),
            );
            return None;
        }
        Some(slot)
    }

    /// A read by the processor; `None` is a bus fault.
    pub fn read(&mut self, address: u32, width: u8) -> Option<u32> {
        if let Some(answer) = self.read_flash_module(address, width) {
            return answer;
        }
        if address >= MCM {
            return Some(self.arbitration.read(address - MCM, width));
        }
        let slot = self.find(address, width, false)?;
        let (now, bus_hz, offset) = (self.now, self.bus_hz(), address & 0xFFF);
        Some(match slot.page {
            0x20 => self.flash.read(offset, width),
            0x37 => self.timer.read(offset, now, bus_hz),
            0x47 | 0x48 => self.sim.read(address - 0x4004_7000),
            page @ 0x49..=0x4D => self.pins.read_port(page as usize - 0x49, offset),
            0x52 => self.watchdog.read(offset, now, bus_hz),
            0x64 => self.clocks.read(offset, now),
            0x66 => self.i2c.read(offset, now, bus_hz, &mut self.witness),
            0x72 => self.usb.read(offset),
            0x7F => self.reset_control.read(offset),
            0xFF => {
                self.timers.show(&mut self.pins, now);
                let word = self.pins.read_gpio(offset & !3);
                narrow(word, offset, width)
            }
            _ => self.read_module(address, width),
        })
    }

    /// A write by the processor; `false` is a bus fault.
    pub fn write(&mut self, address: u32, width: u8, value: u32) -> bool {
        if let Some(answer) = self.write_flash_module(address, width, value) {
            return answer;
        }
        if address >= MCM {
            self.arbitration.write(address - MCM, value);
            return true;
        }
        let Some(slot) = self.find(address, width, true) else {
            return false;
        };
        let (now, bus_hz, offset, byte) = (self.now, self.bus_hz(), address & 0xFFF, value as u8);
        match slot.page {
            0x20 => self
                .flash
                .write(offset, width, value, now, &mut self.witness),
            0x37 => self.timer.write(offset, value, now, bus_hz),
            0x47 | 0x48 => {
                self.sim.write(address - 0x4004_7000, value);
                self.judge_clocks();
            }
            page @ 0x49..=0x4D => self.pins.write_port(page as usize - 0x49, offset, value),
            0x52 => match self.watchdog.write(offset, value as u16, now, bus_hz) {
                Ok(()) => {}
                Err(Trap::WatchdogLocked) => self.witness.saw(
                    Trap::WatchdogLocked,
                    format!("write of {value:#06x} to {address:#010x}, which is locked"),
                ),
                Err(trap) => self.watchdog_bites(trap),
            },
            0x64 => {
                self.clocks.write(offset, byte, now, &mut self.witness);
                self.judge_clocks();
            }
            0x66 => {
                self.i2c
                    .write(offset, byte, (now, bus_hz), &self.pins, &mut self.witness);
            }
            0x72 => {
                self.usb.write(offset, byte, &mut self.witness);
                self.judge_usb_clock();
            }
            0xFF => self.write_gpio(offset, width, value),
            _ => self.write_module(address, width, value),
        }
        true
    }

    /// Notes an access by the processor, and what it did to the sensor bus's wires.
    pub fn note_access(&mut self, address: u32, width: u8, value: Option<u32>, store: bool) {
        const PORT_B: u32 = 0x4004_A000;
        const GPIO: u32 = 0x400F_F000;
        self.journal.note(self.now, || Happening::Register {
            address,
            width,
            value,
            store,
        });
        if store && [PORT_B, GPIO].contains(&(address & !0xFFF)) {
            let (scl, sda) = (self.pins.scl(), self.pins.sda());
            self.journal
                .note(self.now, || Happening::Wires { scl, sda });
        }
    }

    /// GPIO takes narrow accesses: the other bits of PDOR and PDDR stay, those of the other registers are 0.
    fn write_gpio(&mut self, offset: u32, width: u8, value: u32) {
        const PDOR: u32 = 0x00;
        const PDDR: u32 = 0x14;
        let shift = 8 * (offset & 3);
        let mask = narrow(u32::MAX, 0, width) << shift;
        let others = match offset & 0x3C {
            PDOR | PDDR => self.pins.read_gpio(offset & !3) & !mask,
            _ => 0,
        };
        let word = others | value << shift & mask;
        self.pins.write_gpio(offset & !3, word);
    }
}

/// The bytes of a register's word that an access of `width` at `offset` sees.
fn narrow(word: u32, offset: u32, width: u8) -> u32 {
    let unused = 32 - 8 * u32::from(width.clamp(1, 4));
    word >> (8 * (offset & 3)) & u32::MAX >> unused
}
