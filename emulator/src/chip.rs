//! The chip around the processor: which peripheral answers at which address, its clock gate, its interrupt, and what
//! the board connects to it.

mod analog;

mod communication;

mod interrupts;

mod registers;

mod slots;

mod timers;

mod transfers;

pub use analog::Analog;
pub use communication::Communication;
pub use interrupts::{INTERRUPTS, interrupt_name};
pub use slots::peripheral_at;
pub use timers::Timers;

use crate::cpu::Ram;
use crate::host::Host;
use crate::journal::{Happening, Journal};
use crate::mpu9250::Mpu9250;
use crate::peripherals::crc::CrcGenerator;
use crate::peripherals::dma::Dma;
use crate::peripherals::dmamux::DmaMux;
use crate::peripherals::ftfl::{FlashController, Memory};
use crate::peripherals::i2c::I2c;
use crate::peripherals::mcg::ClockGenerator;
use crate::peripherals::pins::{self, Pins};
use crate::peripherals::pit::IntervalTimer;
use crate::peripherals::rcm::{Cause, ResetControl};
use crate::peripherals::register_file::RegisterFile;
use crate::peripherals::sim::SystemIntegration;
use crate::peripherals::smc::ModeController;
use crate::peripherals::tsi::TouchSensing;
use crate::peripherals::usbotg::UsbController;
use crate::peripherals::wdog::Watchdog;
use crate::time::{self, NEVER, Ticks};
use crate::witness::{Trap, Witness};
use slots::{SLOTS, Slot};

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
    /// The flash module with its memories.
    pub flash: FlashController,
    /// Converters and what is connected to them.
    pub analog: Analog,
    /// Timers beside the interval timer.
    pub timers: Timers,
    /// Serial interfaces beside USB and the sensor bus.
    pub communication: Communication,
    /// Touch sensing.
    pub touch: TouchSensing,
    modes: ModeController,
    crc: CrcGenerator,
    dma: Dma,
    dma_mux: DmaMux,
    dma_free_at: Ticks,
    /// The RTC's seconds interrupt is a pulse.
    second: bool,
    /// Register files that a system reset leaves alone.
    kept: RegisterFile,
    rest: RegisterFile,
    /// Why the chip has to be reset now.
    pub reset_wanted: Option<(Cause, &'static str)>,
    complaints_heard: usize,
    /// What the program did that silicon does not forgive.
    pub witness: Witness,
    /// What happens, for those who watch.
    pub journal: Journal,
}

impl Chip {
    /// The chip at power-on with `program` in its flash.
    pub fn new(sensor: Mpu9250, program: &[u8]) -> Chip {
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
            flash: FlashController::new(Memory::new(program)),
            analog: Analog::new(),
            timers: Timers::new(),
            communication: Communication::new(),
            touch: TouchSensing::new(),
            modes: ModeController::new(),
            crc: CrcGenerator::new(),
            dma: Dma::new(),
            dma_mux: DmaMux::default(),
            dma_free_at: 0,
            second: false,
            kept: RegisterFile::default(),
            rest: RegisterFile::default(),
            reset_wanted: None,
            complaints_heard: 0,
            witness: Witness::default(),
            journal: Journal::default(),
        }
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
        self.flash.reset();
        self.sim.set_partition(self.flash.memory.configuration());
        self.analog.reset();
        self.timers.reset();
        self.communication.reset();
        self.touch.reset();
        self.modes = ModeController::new();
        self.crc = CrcGenerator::new();
        self.dma = Dma::new();
        self.dma_mux = DmaMux::default();
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
            self.flash.next_event(),
            self.analog.next_event(),
            self.timers.next_event(),
            self.communication.next_event(),
            self.touch.next_event(),
            self.next_transfer(),
            if self.second { self.now } else { NEVER },
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
        self.advance_modules();
        let journal = &mut self.journal;
        self.i2c
            .advance((now, bus_hz), &self.pins, &mut self.sensor, journal);
        self.hear_the_sensor();
        if now >= self.host.next_event() {
            let clocked = self.usb_clocked();
            self.host
                .advance(now, clocked, &mut self.usb, &self.ram, &mut self.witness);
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

    /// Passes on what the sensor has to complain of since the last time.
    fn hear_the_sensor(&mut self) {
        let list = self.sensor.complaints.list();
        for (_, complaint) in list.iter().skip(self.complaints_heard) {
            if let Some(trap) = complaint.trap() {
                let section = complaint.section();
                self.witness.saw(trap, format!("{complaint} ({section})"));
            }
        }
        self.complaints_heard = list.len();
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

    fn advance_modules(&mut self) {
        let clocks = self.clocks();
        self.flash.advance(self.now);
        self.timers.advance(&clocks);
        self.second = self.timers.rtc.take_second();
        for (converter, trigger) in self.timers.delay.advance(self.now) {
            self.analog.converters[converter].trigger(trigger, &clocks);
        }
        self.analog.advance(&clocks);
        self.communication.advance(&self.pins, &clocks);
        self.touch.advance(self.now);
        for channel in self.timer.take_expired() {
            self.dma_mux.trigger(channel);
        }
        self.transfer();
    }

    /// Drives pin `number` of the board (0 to 33) from outside, or lets go of it.
    pub fn drive(&mut self, number: u8, level: Option<bool>) {
        let Some((port, bit)) = pins::board_pin(number) else {
            return;
        };
        let before = self.pins.level(port, bit);
        self.pins.drive(port, bit, level);
        let after = self.pins.level(port, bit);
        if before != after {
            self.timers.edge(&self.pins, (port, bit), after, self.now);
        }
    }

    /// Level of pin `number` of the board (0 to 33).
    pub fn level(&mut self, number: u8) -> bool {
        self.timers.show(&mut self.pins, self.now);
        pins::board_pin(number).is_some_and(|(port, bit)| self.pins.level(port, bit))
    }

    /// Puts bytes on the receive line of UART `n` (Serial1 is 0); `false` if no pin is connected to it.
    pub fn send_serial(&mut self, n: usize, bytes: &[u8]) -> bool {
        let clocks = self.clocks();
        self.communication.receive(n, bytes, &self.pins, &clocks)
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
        if let Some(answer) = self.read_flash_module(address, width) {
            return answer;
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

    /// The moment, in seconds since power-on.
    pub fn seconds(&self) -> f64 {
        time::seconds(self.now)
    }
}

/// The bytes of a register's word that an access of `width` at `offset` sees.
fn narrow(word: u32, offset: u32, width: u8) -> u32 {
    let unused = 32 - 8 * u32::from(width.clamp(1, 4));
    word >> (8 * (offset & 3)) & u32::MAX >> unused
}
