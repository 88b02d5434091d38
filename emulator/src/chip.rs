//! The chip around the processor: which peripheral answers at which address, its clock gate, its interrupt, and what
//! the board connects to it.

use crate::cpu::Ram;
use crate::host::Host;
use crate::journal::{Happening, Journal};
use crate::mpu9250::Mpu9250;
use crate::peripherals::ftfl::FlashController;
use crate::peripherals::i2c::I2c;
use crate::peripherals::mcg::ClockGenerator;
use crate::peripherals::pins::Pins;
use crate::peripherals::pit::IntervalTimer;
use crate::peripherals::rcm::{Cause, ResetControl};
use crate::peripherals::register_file::RegisterFile;
use crate::peripherals::sim::SystemIntegration;
use crate::peripherals::usbotg::UsbController;
use crate::peripherals::wdog::Watchdog;
use crate::time::{self, NEVER, Ticks};
use crate::witness::{Trap, Witness};

/// A 4 KiB slot of the peripheral bridges (K20 manual, section 4.5).
struct Slot {
    page: u32,
    name: &'static str,
    /// Clock gate as (n, bit) of SIM_SCGCn; `None` is always clocked.
    gate: Option<(u32, u32)>,
    /// Bytes of an access; 0 where any width will do.
    width: u8,
}

const fn slot(page: u32, name: &'static str, gate: Option<(u32, u32)>, width: u8) -> Slot {
    Slot {
        page,
        name,
        gate,
        width,
    }
}

#[rustfmt::skip]
const SLOTS: &[Slot] = &[
    slot(0x00, "AIPS0", None, 4),                slot(0x04, "AXBS", None, 4),
    slot(0x08, "DMA", Some((7, 1)), 0),          slot(0x09, "DMA TCD", Some((7, 1)), 0),
    slot(0x1F, "FMC", None, 4),                  slot(0x20, "FTFL", Some((6, 0)), 0),
    slot(0x21, "DMAMUX", Some((6, 1)), 1),       slot(0x24, "CAN0", Some((6, 4)), 4),
    slot(0x2C, "SPI0", Some((6, 12)), 0),        slot(0x2D, "SPI1", Some((6, 13)), 0),
    slot(0x2F, "I2S0", Some((6, 15)), 4),        slot(0x32, "CRC", Some((6, 18)), 0),
    slot(0x35, "USBDCD", Some((6, 21)), 4),      slot(0x36, "PDB", Some((6, 22)), 4),
    slot(0x37, "PIT", Some((6, 23)), 4),         slot(0x38, "FTM0", Some((6, 24)), 4),
    slot(0x39, "FTM1", Some((6, 25)), 4),        slot(0x3B, "ADC0", Some((6, 27)), 4),
    slot(0x3D, "RTC", Some((6, 29)), 4),         slot(0x3E, "RFVBAT", None, 4),
    slot(0x40, "LPTMR", Some((5, 0)), 4),        slot(0x41, "RFSYS", None, 0),
    slot(0x45, "TSI", Some((5, 5)), 4),          slot(0x47, "SIM", None, 4),
    slot(0x48, "SIM", None, 4),                  slot(0x49, "PORTA", Some((5, 9)), 4),
    slot(0x4A, "PORTB", Some((5, 10)), 4),       slot(0x4B, "PORTC", Some((5, 11)), 4),
    slot(0x4C, "PORTD", Some((5, 12)), 4),       slot(0x4D, "PORTE", Some((5, 13)), 4),
    slot(0x52, "WDOG", None, 2),                 slot(0x61, "EWM", Some((4, 1)), 1),
    slot(0x62, "CMT", Some((4, 2)), 1),          slot(0x64, "MCG", None, 1),
    slot(0x65, "OSC", None, 1),                  slot(0x66, "I2C0", Some((4, 6)), 1),
    slot(0x67, "I2C1", Some((4, 7)), 1),         slot(0x6A, "UART0", Some((4, 10)), 1),
    slot(0x6B, "UART1", Some((4, 11)), 1),       slot(0x6C, "UART2", Some((4, 12)), 1),
    slot(0x72, "USB0", Some((4, 18)), 1),        slot(0x73, "CMP", Some((4, 19)), 1),
    slot(0x74, "VREF", Some((4, 20)), 1),        slot(0x7C, "LLWU", None, 1),
    slot(0x7D, "PMC", None, 1),                  slot(0x7E, "SMC", None, 1),
    slot(0x7F, "RCM", None, 1),                  slot(0x80, "AIPS1", None, 4),
    slot(0xB8, "FTM2", Some((3, 24)), 4),        slot(0xBB, "ADC1", Some((3, 27)), 4),
    slot(0xCC, "DAC0", Some((2, 12)), 0),        slot(0xFF, "GPIO", None, 4),
];

/// Interrupt numbers (K20 manual, table 3-4).
mod irq {
    pub const I2C0: u16 = 24;
    pub const PIT0: u16 = 68;
    pub const USBOTG: u16 = 73;
}

/// Interrupts the modelled peripherals can raise.
pub const INTERRUPTS: [u16; 6] = [
    irq::I2C0,
    irq::PIT0,
    irq::PIT0 + 1,
    irq::PIT0 + 2,
    irq::PIT0 + 3,
    irq::USBOTG,
];

/// The name of the peripheral at `address`, as the manual has it.
pub fn peripheral_at(address: u32) -> Option<&'static str> {
    let page = (address >> 12).checked_sub(0x4_0000)?;
    let slot = SLOTS.iter().find(|slot| slot.page == page)?;
    Some(slot.name)
}

/// Who asks for interrupt `number`, of those that the modelled peripherals can raise.
pub fn interrupt_name(number: u16) -> Option<&'static str> {
    Some(match number {
        irq::I2C0 => "I2C0",
        irq::PIT0 => "PIT0",
        irq::USBOTG => "USBOTG",
        _ if number == irq::PIT0 + 1 => "PIT1",
        _ if number == irq::PIT0 + 2 => "PIT2",
        _ if number == irq::PIT0 + 3 => "PIT3",
        _ => return None,
    })
}

/// Whether reading `address` changes nothing, and finds the same until the next event or access.
pub fn is_steady(address: u32) -> bool {
    const I2C0_C1: u32 = 0x4006_6002;
    const I2C0_S: u32 = 0x4006_6003;
    const MCG_S: u32 = 0x4006_4006;
    const FTFL_FSTAT: u32 = 0x4002_0000;
    const USB_ISTAT: u32 = 0x4007_2080;
    const UART0_S1: u32 = 0x4006_A004;
    const SIM: u32 = 0x4004_7000;
    const GPIO: u32 = 0x400F_F000;
    let page = address & !0xFFF;
    matches!(
        address,
        I2C0_C1 | I2C0_S | MCG_S | FTFL_FSTAT | USB_ISTAT | UART0_S1
    ) || page == SIM
        || page == SIM + 0x1000
        || page == GPIO
}

/// Every peripheral, the sensor, and the host.
#[derive(Debug, Clone)]
pub struct Chip {
    /// The moment the processor is at.
    pub now: Ticks,
    /// SRAM, shared with the processor.
    pub ram: Ram,
    /// Pins and the sensor bus's wires.
    pub pins: Pins,
    /// The sensor bus.
    pub i2c: I2c,
    /// The USB device controller.
    pub usb: UsbController,
    /// The sensor.
    pub sensor: Mpu9250,
    /// The PC.
    pub host: Host,
    watchdog: Watchdog,
    watchdog_resets: u16,
    clocks: ClockGenerator,
    sim: SystemIntegration,
    timer: IntervalTimer,
    /// When the clock generator's output may next change by itself.
    clock_change: Ticks,
    reset_control: ResetControl,
    flash: FlashController,
    rest: RegisterFile,
    flash_configuration: [u8; 2],
    /// Why the chip has to be reset now.
    pub reset_wanted: Option<(Cause, &'static str)>,
    /// What the program did that silicon does not forgive.
    pub witness: Witness,
    /// What happens, for those who watch.
    pub journal: Journal,
}

impl Chip {
    /// The chip at power-on; `flash_configuration` holds FSEC and FOPT.
    pub fn new(sensor: Mpu9250, flash_configuration: [u8; 2]) -> Chip {
        let clocks = ClockGenerator::new();
        let bus_hz = clocks.output_hz(0);
        Chip {
            now: 0,
            ram: Ram::new(),
            pins: Pins::default(),
            i2c: I2c::new(),
            usb: UsbController::new(),
            sensor,
            host: Host::new(),
            watchdog: Watchdog::new(0, bus_hz, 0),
            watchdog_resets: 0,
            clocks,
            sim: SystemIntegration::new(),
            timer: IntervalTimer::new(),
            clock_change: 0,
            reset_control: ResetControl::new(Cause::PowerOn),
            flash: Chip::flash(flash_configuration),
            rest: RegisterFile::default(),
            flash_configuration,
            reset_wanted: None,
            witness: Witness::default(),
            journal: Journal::default(),
        }
    }

    fn flash([security, option]: [u8; 2]) -> FlashController {
        /// Any number will do; a real board's is programmed at PJRC.
        const SERIAL_NUMBER: u32 = 490_000;
        FlashController::new(SERIAL_NUMBER, security, option)
    }

    /// A copy with a SRAM of its own.
    pub fn fork(&self) -> Chip {
        Chip {
            ram: self.ram.copy(),
            ..self.clone()
        }
    }

    /// A system reset: peripherals return to their reset state; SRAM, sensor and host live on.
    pub fn reset(&mut self, cause: Cause) {
        if cause == Cause::Watchdog {
            self.watchdog_resets = self.watchdog_resets.saturating_add(1);
        }
        self.clocks = ClockGenerator::new();
        self.clock_change = self.now;
        self.sim = SystemIntegration::new();
        self.watchdog = Watchdog::new(self.now, self.bus_hz(), self.watchdog_resets);
        self.pins.reset();
        self.i2c = I2c::new();
        self.usb.reset();
        self.timer = IntervalTimer::new();
        self.reset_control = ResetControl::new(cause);
        self.flash = Chip::flash(self.flash_configuration);
        self.rest = RegisterFile::default();
        self.reset_wanted = None;
    }

    /// The processor's clock.
    pub fn core_hz(&self) -> u32 {
        self.sim.divide(self.clocks.output_hz(self.now)).0
    }

    /// The core clock over the flash clock.
    pub fn flash_ratio(&self) -> u32 {
        let (core, _, flash) = self.sim.divide(self.clocks.output_hz(self.now));
        core.checked_div(flash).unwrap_or(1).max(1)
    }

    fn bus_hz(&self) -> u32 {
        self.sim.divide(self.clocks.output_hz(self.now)).1
    }

    fn usb_clocked(&self) -> bool {
        self.sim.gate(4, 18) && self.sim.usb_hz(self.clocks.pll_hz(self.now)) == Some(48_000_000)
    }

    /// When something happens next without the processor's doing.
    pub fn next_event(&self) -> Ticks {
        [
            self.watchdog.next_event(self.bus_hz()),
            self.clocks.next_event(self.now),
            self.timer.next_event(),
            self.i2c.next_event(),
            self.host.next_event(),
        ]
        .into_iter()
        .min()
        .unwrap_or(NEVER)
    }

    /// Lets everything happen that is due at `self.now`.
    pub fn advance(&mut self) {
        let (now, bus_hz) = (self.now, self.bus_hz());
        if let Some(trap) = self.watchdog.expired(now, bus_hz) {
            self.watchdog_bites(trap);
        }
        if now >= self.clock_change {
            self.clock_change = self.clocks.next_event(now);
            self.judge_clocks();
        }
        self.timer.advance(now, bus_hz);
        let journal = &mut self.journal;
        self.i2c
            .advance((now, bus_hz), &self.pins, &mut self.sensor, journal);
        if now >= self.host.next_event() {
            let clocked = self.usb_clocked();
            self.host.advance(now, clocked, &mut self.usb, &self.ram);
            for (_, happening) in self.usb.journal.take() {
                self.journal.note(now, || happening);
            }
        }
    }

    /// Tells the witness of clocks that are too fast, or do not fit each other.
    fn judge_clocks(&mut self) {
        const CORE_LIMIT: u32 = 72_000_000;
        const BUS_LIMIT: u32 = 50_000_000;
        const FLASH_LIMIT: u32 = 25_000_000;
        self.clock_change = self.clocks.next_event(self.now);
        let (core, bus, flash) = self.sim.divide(self.clocks.output_hz(self.now));
        let limits = [
            (Trap::CoreOverSpeed, "core", core, CORE_LIMIT),
            (Trap::BusOverSpeed, "bus", bus, BUS_LIMIT),
            (Trap::FlashOverSpeed, "flash", flash, FLASH_LIMIT),
        ];
        for (trap, clock, hz, limit) in limits {
            if hz > limit {
                self.witness
                    .saw(trap, format!("the {clock} clock became {hz} Hz"));
            }
        }
        if !self.sim.ratios_are_whole() {
            self.witness.saw(
                Trap::ClockRatio,
                format!("core, bus and flash clock became {core}, {bus} and {flash} Hz"),
            );
        }
    }

    fn judge_usb_clock(&mut self) {
        if self.usb.pulled_up() && !self.usb_clocked() {
            self.witness.saw(
                Trap::UsbClock,
                "the device was attached to the bus while its clock is not 48 MHz",
            );
        }
    }

    fn watchdog_bites(&mut self, trap: Trap) {
        self.witness.saw(trap, "the watchdog resets the chip");
        self.reset_wanted
            .get_or_insert((Cause::Watchdog, trap.rule()));
    }

    /// Whether interrupt `number` is asserted.
    pub fn interrupt(&self, number: u16) -> bool {
        match number {
            irq::I2C0 => self.i2c.interrupt(),
            irq::USBOTG => self.usb.interrupt(),
            _ => self.timer.interrupt(usize::from(number - irq::PIT0)),
        }
    }

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
            0xFF => self.pins.read_gpio(offset),
            _ => self.rest.read(address, width),
        })
    }

    /// A write by the processor; `false` is a bus fault.
    pub fn write(&mut self, address: u32, width: u8, value: u32) -> bool {
        let Some(slot) = self.find(address, width, true) else {
            return false;
        };
        let (now, bus_hz, offset, byte) = (self.now, self.bus_hz(), address & 0xFFF, value as u8);
        match slot.page {
            0x20 => self.flash.write(offset, byte),
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
                self.usb.write(offset, byte);
                self.judge_usb_clock();
            }
            0xFF => self.pins.write_gpio(offset, value),
            _ => self.rest.write(address, width, value),
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

    /// The moment, in seconds since power-on.
    pub fn seconds(&self) -> f64 {
        time::seconds(self.now)
    }
}
