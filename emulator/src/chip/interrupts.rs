//! Which interrupt requests the chip raises (K20 manual, table 3-4).

use super::Chip;

/// Numbers of the requests.
mod irq {
    pub const DMA: u32 = 0;
    pub const DMA_ERROR: u32 = 16;
    pub const FTFL: u32 = 18;
    pub const FTFL_COLLISION: u32 = 19;
    pub const I2C0: u32 = 24;
    pub const I2C1: u32 = 25;
    pub const SPI0: u32 = 26;
    /// Status and error of UART0; two more for each of the others.
    pub const UART: u32 = 45;
    pub const ADC: u32 = 57;
    pub const FTM: u32 = 62;
    pub const RTC_ALARM: u32 = 66;
    pub const RTC_SECOND: u32 = 67;
    pub const PIT: u32 = 68;
    pub const PDB: u32 = 72;
    pub const USBOTG: u32 = 73;
    pub const TSI: u32 = 83;
    pub const LPTMR: u32 = 85;
    pub const PORT: u32 = 87;
}

/// Every request the modelled peripherals can raise.
pub const INTERRUPTS: [u16; 48] = [
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 18, 19, 24, 25, 26, 45, 46, 47, 48,
    49, 50, 57, 58, 62, 63, 64, 66, 67, 68, 69, 70, 71, 72, 73, 83, 85, 87, 88, 89, 90, 91,
];

impl Chip {
    /// The requests that are asserted, one bit each.
    pub fn interrupts(&self) -> u128 {
        let mut lines = u128::from(self.dma.interrupts()) << irq::DMA;
        let mut raise = |number: u32, asserted: bool| lines |= u128::from(asserted) << number;
        raise(irq::DMA_ERROR, self.dma.error_interrupt());
        raise(irq::FTFL, self.flash.complete_interrupt());
        raise(irq::FTFL_COLLISION, self.flash.collision_interrupt());
        raise(irq::I2C0, self.i2c.interrupt());
        raise(irq::I2C1, self.communication.i2c1.interrupt());
        raise(irq::SPI0, self.communication.spi.interrupt());
        for (n, uart) in (0..).zip(&self.communication.uarts) {
            raise(irq::UART + 2 * n, uart.status_interrupt());
            raise(irq::UART + 2 * n + 1, uart.error_interrupt());
        }
        for (n, converter) in (0..).zip(&self.analog.converters) {
            raise(irq::ADC + n, converter.interrupt());
        }
        for (n, timer) in (0..).zip(&self.timers.flex) {
            raise(irq::FTM + n, timer.interrupt());
        }
        raise(irq::RTC_ALARM, self.timers.rtc.alarm_interrupt());
        raise(irq::RTC_SECOND, self.second);
        for channel in 0..4 {
            raise(irq::PIT + channel as u32, self.timer.interrupt(channel));
        }
        raise(irq::PDB, self.timers.delay.interrupt());
        raise(irq::USBOTG, self.usb.interrupt());
        raise(irq::TSI, self.touch.interrupt());
        raise(irq::LPTMR, self.timers.low_power.interrupt());
        for port in 0..5 {
            raise(irq::PORT + port as u32, self.pins.interrupt(port));
        }
        lines
    }
}

/// Who asks for interrupt `number`, of those that the modelled peripherals can raise.
pub fn interrupt_name(number: u16) -> Option<&'static str> {
    const PIT: [&str; 4] = ["PIT0", "PIT1", "PIT2", "PIT3"];
    const PORTS: [&str; 5] = ["PORTA", "PORTB", "PORTC", "PORTD", "PORTE"];
    const CHANNELS: [&str; 16] = [
        "DMA0", "DMA1", "DMA2", "DMA3", "DMA4", "DMA5", "DMA6", "DMA7", "DMA8", "DMA9", "DMA10",
        "DMA11", "DMA12", "DMA13", "DMA14", "DMA15",
    ];
    let number = u32::from(number);
    Some(match number {
        irq::DMA..=15 => CHANNELS[number as usize],
        irq::FTFL => "FTFL",
        irq::I2C0 => "I2C0",
        irq::I2C1 => "I2C1",
        irq::SPI0 => "SPI0",
        irq::RTC_ALARM => "RTC_alarm",
        irq::RTC_SECOND => "RTC_second",
        irq::PIT..=71 => PIT[(number - irq::PIT) as usize],
        irq::PDB => "PDB",
        irq::USBOTG => "USBOTG",
        irq::TSI => "TSI",
        irq::LPTMR => "LPTMR",
        irq::PORT..=91 => PORTS[(number - irq::PORT) as usize],
        _ => return None,
    })
}
