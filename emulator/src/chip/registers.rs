//! The registers of the modules that are kept in groups: analog, timers, communication, and direct memory access.

use super::Chip;
use super::communication::Communication;
use crate::peripherals::clocks::Clocks;
use crate::peripherals::ftfl::FLEXRAM_BASE;

/// End of FlexRAM's 4 KiB, of which this chip has 2.
const FLEX_END: u32 = FLEXRAM_BASE + 0x1000;

impl Chip {
    /// The clocks of this moment.
    pub(super) fn clocks(&self) -> Clocks {
        let (core_hz, bus_hz, _) = self.sim.divide(self.clocks.output_hz(self.now));
        Clocks {
            now: self.now,
            core_hz,
            bus_hz,
            fixed_hz: self.clocks.fixed_hz(self.now),
            internal_hz: self.clocks.internal_hz(),
            crystal_hz: crate::peripherals::mcg::CRYSTAL_HZ,
        }
    }

    /// Whether reading `address` changes nothing, and finds the same until the next event or access.
    pub fn is_steady(&self, address: u32) -> bool {
        const I2C0_C1: u32 = 0x4006_6002;
        const I2C0_S: u32 = 0x4006_6003;
        const MCG_S: u32 = 0x4006_4006;
        const FTFL_FSTAT: u32 = 0x4002_0000;
        const FTFL_FCNFG: u32 = 0x4002_0001;
        const USB_ISTAT: u32 = 0x4007_2080;
        const UART0_S1: u32 = 0x4006_A004;
        const SPI0_SR: u32 = 0x4002_C02C;
        const ADC0_SC1A: u32 = 0x4003_B000;
        const SIM: u32 = 0x4004_7000;
        const GPIO: u32 = 0x400F_F000;
        match address {
            I2C0_C1 | I2C0_S | MCG_S | FTFL_FSTAT | FTFL_FCNFG | USB_ISTAT | UART0_S1 | SPI0_SR
            | ADC0_SC1A => true,
            _ if address & !0xFFF == GPIO => !self.timers.reach_pins(&self.pins),
            _ => matches!(address & !0xFFF, SIM | 0x4004_8000),
        }
    }

    /// Reads memory that belongs to the flash module; `None` where the address is not its.
    pub(super) fn read_flash_module(&mut self, address: u32, width: u8) -> Option<Option<u32>> {
        match address {
            0..0x1000_0000 => {
                self.flash.collide(address, &mut self.witness);
                // "Invalid data": erased cells are as good as any.
                Some(Some(u32::MAX))
            }
            0x1000_0000..FLEX_END => Some(self.flash.read_flex(address, width, &mut self.witness)),
            _ => None,
        }
    }

    /// Writes memory that belongs to the flash module; `None` where the address is not its.
    pub(super) fn write_flash_module(
        &mut self,
        address: u32,
        width: u8,
        value: u32,
    ) -> Option<bool> {
        match address {
            0..0x1000_0000 => Some(false),
            0x1000_0000..FLEX_END => {
                let (now, witness) = (self.now, &mut self.witness);
                Some(self.flash.write_flex(address, width, value, now, witness))
            }
            _ => None,
        }
    }

    /// Reads a register of a grouped module.
    pub(super) fn read_module(&mut self, address: u32, width: u8) -> u32 {
        let (now, page, offset) = (self.now, address >> 12 & 0xFF, address & 0xFFF);
        match page {
            0x08 | 0x09 => self.dma.read(address - 0x4000_8000, width),
            0x21 => self.dma_mux.read(offset),
            0x2C => self.communication.spi.read(offset),
            0x32 => self.crc.read(offset, width),
            0x36 => self.timers.delay.read(offset, now),
            0x38 | 0x39 | 0xB8 => self.timers.flex[flex(page)].read(offset, now),
            0x3B | 0xBB => self.analog.converters[usize::from(page == 0xBB)].read(offset),
            0x3D => self.timers.rtc.read(offset, now),
            0x3E | 0x41 => self.kept.read(address, width),
            0x40 => self.timers.low_power.read(offset),
            0x45 => self.touch.read(offset, width),
            0x67 => {
                let bus_hz = self.bus_hz();
                self.communication
                    .i2c1
                    .read(offset, now, bus_hz, &mut self.witness)
            }
            0x6A..=0x6C => self.communication.uarts[page as usize - 0x6A].read(offset),
            0x74 => self.analog.reference.read(offset, now),
            0x7E => self.modes.read(offset),
            0xCC => self.analog.dac.read(offset, width),
            _ => self.rest.read(address, width),
        }
    }

    /// Writes a register of a grouped module.
    pub(super) fn write_module(&mut self, address: u32, width: u8, value: u32) {
        let (page, offset, byte) = (address >> 12 & 0xFF, address & 0xFFF, value as u8);
        let clocks = self.clocks();
        let now = clocks.now;
        match page {
            0x08 | 0x09 => self.dma.write(address - 0x4000_8000, width, value),
            0x21 => self.dma_mux.write(offset, byte),
            0x2C => self.communication.spi.write(offset, value, &clocks),
            0x32 => self.crc.write(offset, width, value),
            0x36 => self.timers.delay.write(offset, value, &clocks),
            0x38 | 0x39 | 0xB8 => self.timers.flex[flex(page)].write(offset, value, &clocks),
            0x3B | 0xBB => {
                self.analog.converters[usize::from(page == 0xBB)].write(offset, value, &clocks)
            }
            0x3D => self.timers.rtc.write(offset, value, now),
            0x3E | 0x41 => self.kept.write(address, width, value),
            0x40 => self.timers.low_power.write(offset, value, &clocks),
            0x45 => self.touch.write(offset, value, now),
            0x67 => {
                let (pins, witness) = (self.pins.second_bus(), &mut self.witness);
                self.communication
                    .i2c1
                    .write(offset, byte, (now, clocks.bus_hz), &pins, witness);
            }
            0x6A..=0x6C => {
                let n = page as usize - 0x6A;
                self.communication.uarts[n].write(
                    offset,
                    byte,
                    now,
                    Communication::uart_hz(n, &clocks),
                );
            }
            0x74 => self.analog.reference.write(offset, byte, now),
            0x7E => self.modes.write(offset, byte),
            0xCC => self.analog.dac.write(offset, width, value),
            _ => self.rest.write(address, width, value),
        }
    }
}

/// Number of the FlexTimer in a slot.
fn flex(page: u32) -> usize {
    match page {
        0xB8 => 2,
        page => page as usize - 0x38,
    }
}
